-- expect: :2: scene.substeps: expected a whole number from 1 to 1000, got 1001
scene { substeps = 1001 }
