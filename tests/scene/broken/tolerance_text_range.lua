-- expect: :2: scene.tolerance: expected a length (m) from 1e-06 to 1, got "2m"
scene { tolerance = '2m' }
