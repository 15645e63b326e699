-- expect: :2: sphere.at: expected three numbers {x, y, z}, each from -10000000 to 10000000, got {0, nan, 0}
sphere { radius = 1, at = { 0, 0 / 0, 0 } }
