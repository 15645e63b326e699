-- expect: compound.parts[2].radius: expected one with a shape or a length
compound { parts = { { radius = 1 }, { size = { 1, 1, 1 }, length = 1 } } }
