-- expect: :2: box.path.loop: expected the last point with the attitude of the first one
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "spline", loop = true, points = { { 0, 0, 0, 0, 1, 0, 0, 0 }, { 1, 0, 0, 0, 1, 1, 0, 0 } } } }
