-- expect: :2: box.path.points: expected no attitudes beside a spin
box { size = { 1, 1, 1 }, kind = "kinematic", spin = { 0, 0, 1 }, path = { kind = "spline", points = { { 0, 0, 0, 0, 1, 0, 0, 0 }, { 1, 1, 0, 0, 1, 0, 0, 0 } } } }
