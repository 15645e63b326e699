-- expect: :2: box.rotation: expected either q or rotation, got both
box { size = { 1, 1, 1 }, q = { 1, 0, 0, 0 }, rotation = { axis = { 0, 0, 1 }, degrees = 9 } }
