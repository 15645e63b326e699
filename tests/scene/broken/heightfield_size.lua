-- expect: heightfield.size: expected two numbers {x, y}, each from 0.001 to 1000000
heightfield { size = { 10, 10, 2 }, cells = { 4, 4 }, height = function(x, y) return 0 end }
