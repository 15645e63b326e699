-- A tour of obsim: boxes fall, while their simulators are killed, and one of them is slow. The page tells what is to be seen.
-- obsim serve tour; with --sync free only those near the slow one wait for it; mpirun -n 2 obsim run tour --duration 4: the same hash on two ranks.
--   -D n=60       how many boxes
--   -D slow=1     the first one's simulator computes for some milliseconds in each step
local n = param("n", 60, { whole = true, min = 1, max = 1000, label = "boxes" })
local slow = param("slow", 0, { whole = true, min = 0, max = 1, label = "slow simulators" })

scene { title = "A tour of obsim", duration = 3600, tour = true }
ground {}
camera "main" { from = { -.5, -.8, .54 }, fov = 30 }

local side = math.ceil(math.sqrt(math.ceil(n / 4)))
for i = 0, n - 1 do
	local column, level = i // 4, i % 4
	box {
		name = i == 0 and slow == 1 and "the slow one" or nil,
		size = { random(.3, 1), random(.3, 1), random(.3, 1) },
		at = { (column % side - (side - 1) / 2) * 1.8, (column // side - (side - 1) / 2) * 1.8, 1.5 + level * 1.8 },
		q = random_rotation(), density = 1000, friction = .5,
		script = i == 0 and slow == 1 and "tour/slow.lua" or nil,
	}
end
