-- expect: :3: hinge.motor: expected the rate that it holds, or the value that it pulls to
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
hinge { "bob", at = { 0, 0, 1 }, axis = { 0, 1, 0 }, motor = { most = 3 } }
