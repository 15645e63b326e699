-- expect: :2: sphere.mass: expected a number above 0
sphere { radius = 1, mass = -5 }
