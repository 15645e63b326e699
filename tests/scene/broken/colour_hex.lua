-- expect: :2: sphere.colour: expected a colour {r, g, b} of numbers from 0 to 1, or "#rrggbb", opaque as all that is drawn, got "#12345g"
sphere { radius = 1, colour = "#12345g" }
