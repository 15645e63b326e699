-- expect: :2: param.n.unit: expected text
local n = param("n", 2, { min = 1, max = 3, unit = 7 })
sphere { radius = n }
