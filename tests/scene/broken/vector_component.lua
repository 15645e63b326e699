-- expect: vector: it has no "w", only x, y, z, norm, aside, dot and cross
ground {}
local w = vector(1, 2, 3).w
