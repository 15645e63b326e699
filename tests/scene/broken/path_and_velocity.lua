-- expect: :2: box.path: expected either velocity or path, got both
box { size = { 1, 1, 1 }, kind = "kinematic", velocity = { 1, 0, 0 }, path = { kind = "sine", amplitude = { 1, 0, 0 }, frequency = 1 } }
