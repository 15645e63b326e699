-- expect: :4: box.size: expected three numbers {x, y, z}, each above 0, up to 1000000, got {1, -2, 3}
ground {}

box { size = { 1, -2, 3 } }
