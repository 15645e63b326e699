-- expect: :2: sphere.density: expected either mass or density, got both
sphere { radius = 1, mass = 1, density = 1 }
