-- expect: :3: stopped after 50 million instructions: does a loop never end?
local n = 0
while true do n = n + 1 end
