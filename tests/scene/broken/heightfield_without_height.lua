-- expect: heightfield.height: expected a function
heightfield { size = { 10, 10 }, cells = { 4, 4 } }
