-- expect: plane.q: expected either normal or q, got both
plane { normal = { 0, 0, 1 }, q = { 1, 0, 0, 0 } }
