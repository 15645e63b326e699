-- A car climbs over hills: a heightfield of a function. Its wheels hang on hinges with motors; balls lie about.
--   -D cells=80      of the heightfield, along each side
--   -D balls=24
local cells = param("cells", 80, { whole = true, min = 10, max = 300, label = "cells along a side" })
local balls = param("balls", 24, { whole = true, min = 0, max = 42 })

scene { title = "A car over hills", duration = 14 }
sky { top = "#5f8fc4", horizon = "#dfe9f0" }
sun { towards = { .35, -.75, .38 } }
material "turf" { friction = .9, colour = "#7d9b5c", roughness = .95 }
material "rubber" { friction = 1.2, density = 500, colour = "#2b2d31" }
material "paint" { friction = .4, density = 120, colour = "#d1495b", roughness = .3 }

local function height(x, y)
	local road = math.exp(-y * y / 8) -- smoother along the middle
	local hills = 1.1 * math.sin(.31 * x) * math.cos(.23 * y) + .5 * math.sin(.7 * x + .4 * y)
	local bumps = .07 * math.sin(3.1 * x) * math.sin(2.7 * y + 1) + .04 * math.sin(5.3 * x + 4.1 * y)
	return hills * (1 - .35 * road) + bumps * (1 - .3 * road)
end
heightfield { name = "hills", material = "turf", size = { 48, 32 }, cells = { cells * 3 // 2, cells }, height = height }

local x, y = -19, 0
local z = height(x, y) + 1.1
local function axle(n, dx)
	for side = -1, 1, 2 do
		local wheel, at = n .. (side < 0 and " right" or " left"), { x + dx, y + .62 * side, z - .22 }
		cylinder { name = wheel, material = "rubber", radius = .36, length = .24, at = at,
		           rotation = { axis = { 1, 0, 0 }, degrees = 90 } }
		hinge { wheel, "car", at = at, axis = { 0, 1, 0 }, motor = { rate = 7, most = 260 } }
	end
end
compound { name = "car", material = "paint", at = { x, y, z }, parts = {
	{ size = { 2.1, .9, .34 } },
	{ size = { 1, .8, .34 }, at = { -.1, 0, .34 } },
} }
axle("front", .72)
axle("rear", -.72)

for i = 1, balls do
	local bx, by = -21 + (i - 1) * 17 % 42 + .3 * random(), (i % 2 * 2 - 1) * random(2.5, 13) -- one in each metre along x
	sphere { radius = random(.15, .4), at = { bx, by, height(bx, by) + random(.6, 2) }, density = 300, friction = .6, restitution = .3 }
end

camera "main" { follow = "car", eye = { x - 5.6, y - 4.2, z + 4.7 }, target = { x + 2.1, y + 1, z - .3 }, fov = 34 }
camera "all" { eye = { -27, -15, 11 }, target = { -8, 0, 0 }, fov = 46 }
camera "behind" { follow = "car", eye = { x - 7, y - 3, z + 3 }, target = { x, y, z } }
