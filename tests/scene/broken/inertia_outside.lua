-- expect: :2: hull.inertia: expected the origin, which is the centre of mass then, well inside the hull
hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, mass = 1, inertia = { 1, 1, 1 } }
