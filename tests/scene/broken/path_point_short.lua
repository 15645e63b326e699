-- expect: :2: box.path.points: expected four numbers {t, x, y, z} as point 2
box { size = { 1, 1, 1 }, kind = "kinematic", path = { kind = "spline", points = { { 0, 0, 0, 0 }, { 1, 1, 0 } } } }
