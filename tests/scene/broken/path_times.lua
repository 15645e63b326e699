-- expect: :2: box.path.points: expected times that begin with 0 and grow, got 1 at point 3
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "spline", points = { { 0, 0, 0, 0 }, { 1, 1, 0, 0 }, { 1, 2, 0, 0 } } } }
