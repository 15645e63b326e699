-- expect: :3: sphere.mass: expected a number from 1e-12 to 1e+12, got 0
ground {}
sphere { radius = 1, mass = 0 }
