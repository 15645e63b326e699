-- expect: :2: box.q: expected a quaternion {w, x, y, z} that is not {0, 0, 0, 0}, got {0, 0, 0, 0}
box { size = { 1, 1, 1 }, q = { 0, 0, 0, 0 } }
