-- expect: :2: box.varying_force: expected none for a static object
box { size = { 1, 1, 1 }, static = true, varying_force = { kind = "pulse", force = { 1, 0, 0 }, to = 1 } }
