-- expect: :2: sphere.group: expected a whole number from 0 to 15, got 32
sphere { radius = 1, group = 32 }
