-- expect: :3: slider.motor: expected a stiffness where it pulls to a value, and only there
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
slider { "bob", axis = { 0, 1, 0 }, motor = { to = 1 } }
