-- expect: box.path.rate: expected either frequency or rate, got both
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "sine", amplitude = { 1, 0, 0 }, frequency = 1, rate = 6 } }
