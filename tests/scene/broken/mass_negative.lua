-- expect: :2: sphere.mass: expected a number from 1e-12 to 1e+12
sphere { radius = 1, mass = -5 }
