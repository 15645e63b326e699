-- expect: :4: 
local t = {}
for i = 1, 100 do t[i] = ("x"):rep(1e5) end
local s = table.concat(t)
