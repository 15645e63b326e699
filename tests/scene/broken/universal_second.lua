-- expect: universal.second.high: expected at most 6.2 (rad) above low, got 7
sphere { name = "bob", radius = 1, at = { 0, 0, 5 } }
universal { "bob", at = { 0, 0, 7 }, axis = { 1, 0, 0 }, across = { 0, 1, 0 }, second = { low = -3, high = 4 } }
