-- expect: :2: scene.substeps: expected either tolerance or substeps, got both
scene { tolerance = .001, substeps = 8 }
