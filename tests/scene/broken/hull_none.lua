-- expect: hull.points: expected a list of 4 to 4096 points {x, y, z}, got
hull { at = { 0, 0, 1 } }
