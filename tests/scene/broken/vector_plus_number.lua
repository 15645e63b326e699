-- expect: vector: expected a vector, got a number
ground {}
local v = vector(1, 2, 3) + 1
