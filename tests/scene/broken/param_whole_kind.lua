-- expect: :2: param.n.whole: expected true or false, got 1
local n = param("n", 2, { whole = 1 })
sphere { radius = n }
