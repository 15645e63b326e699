-- expect: :2: box.path.points: expected eight numbers {t, x, y, z, qw, qx, qy, qz}, as point 1 has, as point 2
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "spline", points = { { 0, 0, 0, 0, 1, 0, 0, 0 }, { 1, 1, 0, 0 } } } }
