-- expect: :2: scene.substeps: expected a whole number from 1 to 1000, got 0
scene { substeps = 0 }
