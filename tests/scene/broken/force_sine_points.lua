-- expect: :2: box.varying_force.points: expected none for kind = "sine"
box { size = { 1, 1, 1 }, varying_force = { kind = "sine", force = { 1, 0, 0 }, frequency = 1, points = { { 0, 0, 0, 0 } } } }
