-- expect: hinge.axis: expected a direction {x, y, z}, or q, the attitude of a frame whose z is the axis, got both
box { name = "door", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
hinge { "door", at = { 0, 0, 2 }, axis = { 0, 0, 1 }, q = { 1, 0, 0, 0 } }
