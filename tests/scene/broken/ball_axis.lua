-- expect: :3: ball.axis: unknown field
box { name = "bob", size = { 1, .1, 2 }, at = { .5, 0, 2 } }
ball { "bob", at = { 0, 0, 2 }, axis = { 0, 0, 1 } }
