-- expect: :2: ball: expected names of one or two objects, as in ball { "door", "frame", ... }
ball { at = { 0, 0, 2 } }
