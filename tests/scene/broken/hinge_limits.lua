-- expect: :3: hinge.high: expected at least low, 1, got -1
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
hinge { "bob", at = { 0, 0, 1 }, axis = { 0, 1, 0 }, low = 1, high = -1 }
