-- expect: :3: distance.length: expected rest, low and high in its place
sphere { name = "bob", radius = .1, at = { 1, 0, 1 } }
distance { "bob", to = { 0, 0, 1 }, length = 1, stiffness = 3 }
