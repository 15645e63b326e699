-- expect: :4: box.size: expected three numbers {x, y, z}, each from 1e-06 to 1000000, got {1, -2, 3}
ground {}

box { size = { 1, -2, 3 } }
