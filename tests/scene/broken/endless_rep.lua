-- expect: :2: string.rep: a string grew beyond 1 MiB
local s = (""):rep(1e15)
