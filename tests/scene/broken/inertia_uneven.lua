-- expect: :2: capsule.inertia: expected the first two alike for a capsule, got 1 and 1.1
capsule { radius = 1, length = 1, mass = 1, inertia = { 1, 1.1, 1 } }
