-- expect: :3: hinge.axis: expected
box { name = "door", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
hinge { "door", at = { 0, 0, 2 } }
