-- expect: :2: box.varying_force.force: expected
box { size = { 1, 1, 1 }, varying_force = { kind = "pulse", force = { 0 / 0, 0, 0 }, to = 1 } }
