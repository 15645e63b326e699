-- expect: :3: distance: expected two points that are apart: give it from and to
box { name = "bob", size = { 1, 1, 1 }, at = { 0, 0, 2 } }
distance { "bob" }
