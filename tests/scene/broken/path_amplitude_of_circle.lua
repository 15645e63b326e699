-- expect: :2: sphere.path.amplitude: expected none for kind = "circle"
sphere { radius = 1, kind = "kinematic", path = { kind = "circle", centre = { 1, 0, 0 }, frequency = 1, amplitude = { 1, 0, 0 } } }
