-- expect: :2: scene.tolerance: 0.001% of the thinnest object's 0.02 m is 2e-07 m; expected 1e-06 to 1 m
scene { tolerance = ".001%" }
sphere { radius = .01, at = { 0, 0, 1 } }
