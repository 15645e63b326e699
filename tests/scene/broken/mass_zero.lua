-- expect: :3: sphere.mass: expected a number above 0, up to 1e+15, got 0
ground {}
sphere { radius = 1, mass = 0 }
