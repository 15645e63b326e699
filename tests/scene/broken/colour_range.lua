-- expect: :2: sphere.colour: expected a colour {r, g, b} of numbers from 0 to 1, or "#rrggbb", got {255, 0, 0}
sphere { radius = 1, colour = { 255, 0, 0 } }
