-- expect: ball.low: unknown field
sphere { name = "bob", radius = 1, at = { 0, 0, 5 } }
ball { "bob", at = { 0, 0, 7 }, low = -1 }
