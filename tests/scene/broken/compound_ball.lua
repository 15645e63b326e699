-- expect: compound.parts[1].length: expected none for a sphere
compound { parts = { { shape = "sphere", radius = 1, length = 1 } } }
