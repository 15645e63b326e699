-- expect: compound.parts: expected a list of 1 to 15 parts, got 0
compound { parts = {} }
