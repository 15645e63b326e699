-- expect: compound.parts[1]: expected either size, of a box, or points, of a hull
compound { parts = { { at = { 1, 1, 1 } } } }
