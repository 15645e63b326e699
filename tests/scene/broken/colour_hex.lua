-- expect: :2: sphere.colour: expected a colour {r, g, b} of numbers from 0 to 1, or "#rrggbb", got "#12345g"
sphere { radius = 1, colour = "#12345g" }
