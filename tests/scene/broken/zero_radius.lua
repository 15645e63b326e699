-- expect: :2: sphere.radius: expected a number from 1e-06 to 1000000, got 0
sphere { radius = 0 }
