-- expect: :2: box.path: expected kind = "kinematic" with it
box { size = { 1, 1, 1 }, path = { kind = "sine", amplitude = { 1, 0, 0 }, frequency = 1 } }
