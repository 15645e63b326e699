-- expect: :3: ball: expected objects that are there from the start, "bob" is born at 1
box { name = "bob", size = { 1, .1, 2 }, at = { .5, 0, 2 }, born = 1 }
ball { "bob", at = { 0, 0, 2 } }
