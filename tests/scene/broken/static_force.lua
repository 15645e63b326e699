-- expect: :2: box.force: expected none for a static object
box { size = { 1, 1, 1 }, static = true, force = { 0, 0, 1 } }
