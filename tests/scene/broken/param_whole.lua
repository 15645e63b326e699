-- expect: :2: param.n: expected a whole number as default, as it says whole = true, got 2.5
local n = param("n", 2.5, { whole = true })
sphere { radius = n }
