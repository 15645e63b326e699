-- expect: hull.points: expected at least four different points
hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } } }
