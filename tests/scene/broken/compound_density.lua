-- expect: compound.density: expected none where its parts have one
compound { density = 3, parts = { { size = { 1, 1, 1 }, density = 3 } } }
