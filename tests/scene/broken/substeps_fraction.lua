-- expect: :2: scene.substeps: expected a whole number from 1 to 1000, got 2.5
scene { substeps = 2.5 }
