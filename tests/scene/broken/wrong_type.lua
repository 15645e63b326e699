-- expect: :3: box.size: expected three numbers {x, y, z}, each above 0, up to 1000000, got "big"
-- the call starts in line 3
box { size = "big" }
