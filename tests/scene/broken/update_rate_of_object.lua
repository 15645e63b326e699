-- expect: :2: sphere.update_rate: expected a number above 0, up to 100000
sphere { radius = 1, update_rate = 1e6 }
