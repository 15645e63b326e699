-- expect: :3: hinge: expected two different objects, got "door" twice
box { name = "door", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
hinge { "door", "door", at = { 0, 0, 2 }, axis = { 0, 0, 1 } }
