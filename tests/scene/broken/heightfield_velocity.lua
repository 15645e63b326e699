-- expect: heightfield.velocity: unknown field
heightfield { size = { 10, 10 }, cells = { 4, 4 }, height = function(x, y) return 0 end, velocity = { 1, 0, 0 } }
