-- What shapes cost: bodies in a loose grid, turned at random, drop and pile up. All have their corners on a sphere of the
-- same radius: boxes with equal edges, or hulls of random points.
--   -D points=8     of a hull; 0: boxes
--   -D n=200        bodies
--   -D upright=true boxes of half a metre, hardly turned, which fall into columns instead of a heap: for comparison
local n = param("n", 200, { whole = true, min = 1, max = 5000 })
local count = param("points", 0, { whole = true, min = 0, max = 64 })
local upright = param("upright", false)
local radius = .3

scene { title = "Pile of " .. n, duration = 3 }
material "stone" { friction = .5, restitution = 0, density = 1000 }
ground {}

local function random_points()
	local points = {}
	for i = 1, count do
		local p = { random(-1, 1), random(-1, 1), random(-1, 1) }
		local scale = radius / math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2)
		points[i] = { p[1] * scale, p[2] * scale, p[3] * scale }
	end
	return points
end

local function lean()
	return { 1, random(-.15, .15), random(-.15, .15), random(-.15, .15) }
end

for i = 0, n - 1 do
	local body = {
		at = {
			(i % 6 - 2.5) * .75 + random(-.05, .05),
			(i // 6 % 6 - 2.5) * .75 + random(-.05, .05),
			.75 + i // 36 * .8,
		},
		q = upright and lean() or random_rotation(),
		material = "stone",
	}
	if count > 0 then
		body.points = random_points()
		hull(body)
	else
		local edge = upright and .5 or 2 * radius / math.sqrt(3)
		body.size = { edge, edge, edge }
		box(body)
	end
end
