-- expect: :2: box.varying_force.frequency: expected
box { size = { 1, 1, 1 }, varying_force = { kind = "sine", force = { 1, 0, 0 }, frequency = 0 } }
