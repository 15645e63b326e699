-- expect: :3: slider.motor: expected damping only where it pulls to a value
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
slider { "bob", axis = { 0, 1, 0 }, motor = { rate = 1, damping = 2 } }
