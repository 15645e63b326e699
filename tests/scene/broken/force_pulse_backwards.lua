-- expect: :2: box.varying_force.to: expected a time after from, got 1
box { size = { 1, 1, 1 }, varying_force = { kind = "pulse", force = { 1, 0, 0 }, from = 2, to = 1 } }
