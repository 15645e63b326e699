-- expect: compound.parts
compound { at = { 0, 0, 1 } }
