-- expect: :3: ball.motor: unknown field
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
ball { "bob", at = { 0, 0, 1 }, motor = { rate = 1 } }
