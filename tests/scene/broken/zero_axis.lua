-- expect: :2: box.rotation.axis: expected a direction {x, y, z} that is not {0, 0, 0}, got {0, 0, 0}
box { size = { 1, 1, 1 }, rotation = { axis = { 0, 0, 0 }, degrees = 5 } }
