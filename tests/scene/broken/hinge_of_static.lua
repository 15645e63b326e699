-- expect: :3: hinge: expected an object that is neither static nor kinematic
box { name = "wall", size = { 1, .1, 2 }, at = { .5, 0, 2 }, static = true }
hinge { "wall", at = { 0, 0, 2 }, axis = { 0, 0, 1 } }
