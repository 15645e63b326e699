-- expect: compound.parts: expected a density of all of them, or of none
compound { parts = { { size = { 1, 1, 1 }, density = 3 }, { size = { 1, 1, 1 }, at = { 1, 0, 0 } } } }
