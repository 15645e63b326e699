-- expect: :2: box.update_rate: expected none for a static object, which has no steps
box { size = { 1, 1, 1 }, static = true, update_rate = 100 }
