-- expect: heightfield.static: expected true or nothing: it never moves
heightfield { size = { 10, 10 }, cells = { 4, 4 }, height = function(x, y) return 0 end, static = false }
