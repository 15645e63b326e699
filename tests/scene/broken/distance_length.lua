-- expect: :3: distance.length: expected 2, as far as its points are apart, got 3
box { name = "bob", size = { 1, 1, 1 }, at = { 0, 0, 2 } }
distance { "bob", to = { 0, 0, 4 }, length = 3 }
