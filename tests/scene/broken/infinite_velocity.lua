-- expect: :2: sphere.velocity: expected three numbers {x, y, z}, each from -100000 to 100000, got {inf, 0, 0}
sphere { radius = 1, velocity = { 1 / 0, 0, 0 } }
