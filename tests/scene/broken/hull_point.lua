-- expect: hull.points[3]: expected three numbers {x, y, z}, each from -1000000 to 1000000, got
hull { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, "one", 0 }, { 0, 0, 1 } } }
