-- expect: :2: box.varying_force.points: expected times that begin with 0 and grow, got 1 at point 3
box { size = { 1, 1, 1 }, varying_force = { kind = "linear", points = { { 0, 1, 0, 0 }, { 1, 1, 0, 0 }, { 1, 2, 0, 0 } } } }
