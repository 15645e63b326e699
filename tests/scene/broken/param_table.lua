-- expect: :2: param.n: expected a default that is a number, text, true or false, got a table
local n = param("n", {})
