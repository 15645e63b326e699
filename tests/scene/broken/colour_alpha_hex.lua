-- expect: :2: sphere.colour: expected a colour {r, g, b} of numbers from 0 to 1, or "#rrggbb", opaque as all that is drawn, got "#ff000080"
sphere { radius = 1, mass = 1, colour = "#ff000080" }
