-- expect: :3: hinge: unknown object "dor", did you mean "door"?
box { name = "door", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
hinge { "dor", at = { 0, 0, 2 }, axis = { 0, 0, 1 } }
