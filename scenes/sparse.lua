-- Sparse field: boxes far apart are thrown up at random, bounce and come to rest. Most of the time nothing touches
-- anything: a simulator that computes only what happens has little to do.
--   -D n=200         how many boxes
--   -D spacing=4.0   m
local n = param("n", 200, { whole = true, min = 1, max = 999999, label = "boxes" })
local spacing = param("spacing", 4.0, { min = 2, max = 100, unit = "m" })

scene { title = "Sparse field", duration = 10 }
material "rubber" { friction = .5, restitution = .8, density = 1000 }
ground { material = "rubber" }
camera "main" { from = { -.4, -.8, .45 }, fov = 32 }

local side = math.ceil(math.sqrt(n))

for i = 0, n - 1 do
	box {
		size = { random(.2, 1), random(.2, 1), random(.2, 1) },
		at = {
			(i % side - (side - 1) / 2) * spacing,
			(i // side - (side - 1) / 2) * spacing,
			random(2, 10),
		},
		q = random_rotation(),
		velocity = { random(-1, 1), random(-1, 1), random(0, 4) },
		spin = { random(-1, 1), random(-1, 1), random(-1, 1) },
		material = "rubber",
	}
end
