-- expect: heightfield.cells: expected two whole numbers {x, y}, each from 1 to 250000
heightfield { size = { 10, 10 }, cells = { 4, 0 }, height = function(x, y) return 0 end }
