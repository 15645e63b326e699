-- Scenes cannot compute with the memory address of a table: they cannot read it.
local where = tostring({}):sub(-5)
box { size = { 1, 1, 1 }, at = { 0, 0, 1 + (tonumber(where, 16) or 0) / 1e4 } }
ground {}
