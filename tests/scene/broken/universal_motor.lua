-- expect: universal.second.motor: expected the rate that it holds, or the value that it pulls to
sphere { name = "bob", radius = 1, at = { 0, 0, 5 } }
universal { "bob", at = { 0, 0, 7 }, axis = { 1, 0, 0 }, across = { 0, 1, 0 }, second = { motor = { most = 3 } } }
