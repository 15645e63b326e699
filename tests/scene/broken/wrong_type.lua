-- expect: :3: box.size: expected three numbers {x, y, z}, each from 1e-06 to 1000000, got "big"
-- the call starts in line 3
box { size = "big" }
