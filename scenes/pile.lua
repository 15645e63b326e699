-- Pile: boxes of half a metre, in a loose cubic grid and slightly turned, drop half a metre and pile up.
--   -D n=6      boxes along each edge of the grid; n^3 boxes
--   -D e=0.0    restitution
local n = param("n", 6, { whole = true, min = 1, max = 40, label = "boxes along an edge" })
local e = param("e", 0.0, { min = 0, max = 1, label = "restitution" })

scene { title = "Pile of " .. n * n * n .. " boxes", duration = 10 }
material "box" { friction = .5, restitution = e, density = 1000 }
ground {}
camera "main" { from = { -.6, -.8, .55 }, fov = 32 }

local colours = { "#e4572e", "#f08a24", "#f3a712", "#8fb339", "#29a19c", "#3f7cac" } -- by layer

for z = 0, n - 1 do
	for y = 0, n - 1 do
		for x = 0, n - 1 do
			box {
				size = { .5, .5, .5 },
				at = {
					(x - (n - 1) / 2) * .75 + random(-.05, .05),
					(y - (n - 1) / 2) * .75 + random(-.05, .05),
					.75 + z * .8,
				},
				q = { 1, random(-.15, .15), random(-.15, .15), random(-.15, .15) },
				material = "box",
				colour = colours[z % #colours + 1],
			}
		end
	end
end
