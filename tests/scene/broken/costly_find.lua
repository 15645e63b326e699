-- expect: :3: pattern too costly
local a = ("a"):rep(1e6)
print(a:find(("a"):rep(5e5) .. "b", 1, true))
