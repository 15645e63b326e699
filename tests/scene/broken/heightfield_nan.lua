-- expect: heightfield.height: expected a number from -1000000 to 1000000 m, got
heightfield { size = { 10, 10 }, cells = { 4, 4 }, height = function(x, y) return x / 0 end }
