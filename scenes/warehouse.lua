-- A warehouse: crates and barrels arrive on a belt, a sorter pushes the blue ones onto a second belt, and each belt fills
-- a pallet. Scripts create the goods, watch the belt, and take them away in the end.
--   -D every=1.1      s, between two arrivals
--   -D speed=1.1      m/s, of the belts
local every = param("every", 1.1, { min = .3, max = 60, label = "time between arrivals", unit = "s" })
local speed = param("speed", 1.1, { min = .1, max = 4, label = "speed of the belts", unit = "m/s" })

scene { title = "A warehouse", duration = 40, room = 200 }
ground { colour = "#8e9296", pattern = "slabs" }
sky { top = "#8fa3b5", horizon = "#e3e6e8" }
sun { towards = { -.45, -.7, .8 } }
material "belt" { friction = .9, colour = "#26292e" }
material "frame" { friction = .3, colour = "#e0a02c", roughness = .4 }
material "wall" { friction = .15, colour = "#8c939b" }
material "pallet" { friction = .7, density = 500, colour = "#b58b58" }
camera "main" { eye = { -1.8, -7.42, 5.29 }, target = { .45, .9, .9 }, fov = 40 }
camera "sorter" { eye = { -2.6, -3.6, 2.4 }, target = { .2, .2, .8 }, fov = 44 }

script "warehouse/source.lua"
script "warehouse/goods.lua"

local top = .8 -- m, height of the belts
local function belt(name, x, y, length, width, direction)
	local along = direction[1] ~= 0
	box {
		name = name, static = true, material = "belt", size = along and { length, width, .1 } or { width, length, .1 }, at = { x, y, top - .05 },
		surface_velocity = { speed * direction[1], speed * direction[2], 0 },
	}
	for side = -1, 1, 2 do
		local off = side * (width / 2 + .05)
		box { static = true, material = "frame", size = along and { length, .1, .16 } or { .1, length, .16 }, at = along and { x, y + off, top - .06 } or { x + off, y, top - .06 } }
	end
	for _, end_ in ipairs { -.4, .4 } do
		local p = along and { x + end_ * length, y } or { x, y + end_ * length }
		box { static = true, material = "wall", size = { .14, .14, top - .15 }, at = { p[1], p[2], (top - .15) / 2 } }
	end
end
belt("main belt", -1.2, 0, 6.2, .9, { 1, 0, 0 })
belt("on", 3.1, 0, 2.4, .9, { 1, 0, 0 })
belt("side", .55, 2.6, 3.2, .9, { 0, 1, 0 })

-- Walls that keep goods in, and the sorter: a plate that sweeps across the belt when a blue one comes, for the source
-- sends one red and one blue by turns.
box { name = "gate", static = true, material = "wall", size = { .1, 1.4, .3 }, at = { -4.3, 0, top + .15 } }
local period = 2 * every
local meets = every + 4.55 / speed - .2 -- s: when the first blue one is before the side belt
local phase = meets % period
box {
	name = "sorter", kind = "kinematic", colour = "#c43d2f", friction = .1, size = { .8, .12, .34 }, at = { .55, -.62, top + .21 },
	path = { kind = "spline", loop = true, points = phase + .8 < period and {
		{ 0, 0, 0, 0 }, { phase, 0, 0, 0 }, { phase + .35, 0, 1.05, 0 }, { phase + .75, 0, 0, 0 }, { period, 0, 0, 0 },
	} or { { 0, 0, 0, 0 }, { .1, 0, 0, 0 }, { .45, 0, 1.05, 0 }, { .85, 0, 0, 0 }, { period, 0, 0, 0 } } },
}

-- Pallets at the ends, and bins round them.
local function bin(x, y)
	box { static = true, material = "pallet", size = { 1.7, 1.7, .14 }, at = { x, y, .07 } }
	for k = -1, 1, 2 do
		box { static = true, material = "wall", size = { .08, 1.7, .5 }, at = { x + .85 * k, y, .25 } }
		box { static = true, material = "wall", size = { 1.7, .08, .5 }, at = { x, y + .85 * k, .25 } }
	end
end
bin(5.3, 0)
bin(.55, 5.2)

box { name = "source", static = true, material = "frame", size = { .6, 1, .6 }, at = { -4.1, 0, 2 }, script = "warehouse/source.lua",
      state = { every = every, x = -3.9, z = 1.25 } }

-- Shelves with goods at rest, which cost nothing.
for shelf, x in ipairs { -3.6, -1.4, 2.9 } do
	for level = 0, 2 do
		local z = .5 + .8 * level
		box { static = true, material = "frame", size = { 1.8, .8, .06 }, at = { x, 3, z } }
		for k = 0, 2 do
			local high = .3 + .05 * ((k + shelf) % 3)
			box {
				density = 200, friction = .6, colour = ({ "#b08a57", "#9c7a4c", "#c29a63" })[1 + (k + level) % 3], size = { .48, .5, high },
				at = { x - .58 + .58 * k, 3, z + .03 + high / 2 },
			}
		end
	end
	for k = -1, 1, 2 do
		for d = -1, 1, 2 do
			box { static = true, material = "wall", size = { .06, .06, 2.4 }, at = { x + .93 * k, 3 + .43 * d, 1.2 } }
		end
	end
end
