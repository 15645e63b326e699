-- Falling boxes: n boxes of random size and attitude drop on a plane in columns of four
-- and come to rest in a heap (Elfizar et al., the scene of the paper).
--   -D n=100      how many boxes
--   --seed 1      other sizes and attitudes
local n = param("n", 100, { whole = true, min = 1, max = 100000, label = "boxes" })

scene { title = "Falling boxes", duration = 10 }
ground {}
camera "main" { from = { -.5, -.8, .54 }, fov = 30 }

local spacing = 1.8 -- m: more than the longest diagonal, so that no two boxes start in contact
local side = math.ceil(math.sqrt(math.ceil(n / 4)))

for i = 0, n - 1 do
	local column, level = i // 4, i % 4
	box {
		size = { random(.2, 1), random(.2, 1), random(.2, 1) },
		at = {
			(column % side - (side - 1) / 2) * spacing,
			(column // side - (side - 1) / 2) * spacing,
			1.5 + level * spacing,
		},
		q = random_rotation(),
		density = 1000,
		friction = .5,
	}
end
