-- expect: :3: apart: expected names of two objects
box { name = "bob", size = { 1, 1, 1 } }
apart { "bob" }
