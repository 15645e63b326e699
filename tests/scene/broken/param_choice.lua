-- expect: :2: param.kind: expected "a" or "b", got "c"
local kind = param("kind", "c", { "a", "b" })
