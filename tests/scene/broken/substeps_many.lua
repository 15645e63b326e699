-- expect: :2: scene.substeps: expected a whole number from 1 to 256, got 257
scene { substeps = 257 }
