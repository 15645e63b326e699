-- expect: :2: box.mass: expected none for a static object, got 3
box { size = { 1, 1, 1 }, static = true, mass = 3 }
