-- expect: :2: scene.tolerance: expected a number from 1e-06 to 1, got 0
scene { tolerance = 0 }
