-- expect: compound.parts[1].rotation: expected either q or rotation, got both
compound { parts = { { size = { 1, 1, 1 }, q = { 1, 0, 0, 0 }, rotation = { axis = { 0, 0, 1 }, degrees = 3 } } } }
