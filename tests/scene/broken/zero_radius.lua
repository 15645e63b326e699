-- expect: :2: sphere.radius: expected a number above 0, up to 1000000, got 0
sphere { radius = 0 }
