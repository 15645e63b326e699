-- expect: :2: sphere.mass: expected from 1e-12 to 1e+15 kg, got 4.189e-18
sphere { radius = 1e-7 }
