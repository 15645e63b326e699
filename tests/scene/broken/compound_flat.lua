-- expect: compound.parts[1]: expected points that are not all in one plane
compound { parts = { { points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } } } } }
