-- expect: :2: box.path.points: expected less than half a turn from point 1 to point 2
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "spline", points = { { 0, 0, 0, 0, 1, 0, 0, 0 }, { 1, 1, 0, 0, 0, 0, 0, 1 } } } }
