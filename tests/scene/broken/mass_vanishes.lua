-- expect: :2: sphere.mass: expected from 1e-12 to 1e+12 kg, got 4.188
sphere { radius = 1e-6 }
