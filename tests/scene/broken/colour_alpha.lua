-- expect: :2: sphere.colour: expected a colour {r, g, b} of numbers from 0 to 1, or "#rrggbb", opaque as all that is drawn, got {1, 0, 0, 0}
sphere { radius = 1, mass = 1, colour = { 1, 0, 0, 0 } }
