-- expect: :3: hinge.high: expected at most 6.2 (rad) above low, got 6.28
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
hinge { "bob", at = { 0, 0, 1 }, axis = { 0, 1, 0 }, low = -3.14, high = 3.14 }
