-- expect: compound.parts[1].sise
compound { parts = { { sise = { 1, 1, 1 } } } }
