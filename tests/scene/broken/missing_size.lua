-- expect: :2: box.size: expected three numbers {x, y, z}, each from 1e-06 to 1000000, got nothing
box { at = { 0, 0, 1 } }
