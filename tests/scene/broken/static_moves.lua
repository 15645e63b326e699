-- expect: :2: box.velocity: expected none for a static object
box { size = { 1, 1, 1 }, static = true, velocity = { 1, 0, 0 } }
