-- expect: :2: random: expected low <= high, got 2 and 1
local x = random(2, 1)
