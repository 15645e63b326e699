-- expect: heightfield.cells: expected at most 250000, got 1000 times 1000
heightfield { size = { 10, 10 }, cells = { 1000, 1000 }, height = function(x, y) return 0 end }
