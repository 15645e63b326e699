-- expect: compound.parts: expected the centre of mass inside
compound { mass = 1, inertia = { 1, 1, 1 }, parts = { { size = { 1, 1, 1 }, at = { 3, 0, 0 } } } }
