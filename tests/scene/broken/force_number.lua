-- expect: :2: sphere.force: expected three numbers {x, y, z}, each from -1e+15 to 1e+15, got 5
sphere { radius = 1, force = 5 }
