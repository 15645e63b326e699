-- expect: :2: box.path.kind: expected "sine" or "circle" or "spline", got nothing
box { size = { 1, 1, 1 }, kind = "kinematic", path = { amplitude = { 1, 0, 0 }, frequency = 1 } }
