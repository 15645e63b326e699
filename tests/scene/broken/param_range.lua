-- expect: :2: param.n: expected a number of at least 1, got 0
local n = param("n", 0, { min = 1 })
