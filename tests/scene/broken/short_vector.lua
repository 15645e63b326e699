-- expect: :2: box.at: expected three numbers {x, y, z}, each from -10000000 to 10000000, got {1, 2}
box { size = { 1, 1, 1 }, at = { 1, 2 } }
