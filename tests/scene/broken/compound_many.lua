-- expect: compound.parts: expected a list of 1 to 15 parts, got 16
local p = {} for i = 1, 16 do p[i] = { size = { 1, 1, 1 }, at = { i, 0, 0 } } end compound { parts = p }
