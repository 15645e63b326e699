-- expect: :3: a string grew beyond 1 MiB
local s = "x"
for i = 1, 100 do s = s .. s end
