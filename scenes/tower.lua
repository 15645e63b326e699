-- A round tower of loose stones that three shots knock down, while its simulators are killed: the tower falls the same way,
-- to the bit. obsim run tower --isolation process --fault kill:p=.002 --colour-by worker --out tower.mp4
-- With obsim serve tower, pick a stone and kill its worker.
--   -D rows=16        of stones
--   -D speed=24       m/s, of a shot
local rows = param("rows", 16, { whole = true, min = 1, max = 60, label = "rows of stones" })
local speed = param("speed", 24.0, { min = 1, max = 60, label = "speed of a shot", unit = "m/s" })
local around, radius, height = 14, 1.7, .3

scene { title = "A tower falls", duration = 6, tolerance = .01 }
ground { colour = "#9aa583" }
sky { top = "#5b8fc7", horizon = "#efe6d8" }
sun { towards = { -.8, -.35, .6 } }
material "stone" { friction = .6, density = 2200, restitution = 0 }
material "iron" { friction = .4, density = 7800, colour = "#30343b" }
camera "main" { eye = { -5.27, -9.97, 7.72 }, target = { .5, 0, 2.1 }, fov = 40 }
camera "ball" { follow = "ball", eye = { -4.5, -2, 1.4 }, target = { 0, 0, 0 }, fov = 50 }

local palette = { "#d8c9a8", "#c9b38c", "#bfa77e", "#d1bd97", "#b49b74" }

-- The corners of a stone about the point (radius, 0, 0): a part of a ring, from -share to share of its place.
local function wedge(share, high)
	local points = {}
	for side = -1, 1, 2 do
		local angle = side * share * math.pi / around
		for _, r in ipairs { radius - .25, radius + .25 } do
			for up = -1, 1, 2 do
				points[#points + 1] = { r * math.cos(angle), r * math.sin(angle), up * high / 2 }
			end
		end
	end
	return points
end
local stone, merlon = wedge(.995, height), wedge(.8, .4)

for row = 0, rows - 1 do
	for k = 0, around - 1 do
		local turn = (k + row % 2 / 2) / around
		local door = row < 5 and math.abs(turn - .75) < .07
		if not door then
			hull { points = stone, at = { 0, 0, (row + .5) * height }, rotation = { axis = { 0, 0, 1 }, degrees = 360 * turn }, material = "stone",
			       colour = palette[1 + (7 * k + 3 * row) % #palette] }
		end
	end
end
for k = 0, around - 1, 2 do -- battlements
	hull { points = merlon, at = { 0, 0, rows * height + .2 }, rotation = { axis = { 0, 0, 1 }, degrees = 360 * (k + rows % 2 / 2) / around },
	       material = "stone", colour = "#c9b38c" }
end
-- Three shots: each from 11 m away, a second after the one before, at a height of 1.2 m.
for shot, degrees in ipairs { 200, 250, 160 } do
	local angle, time = math.rad(degrees), 11 / speed
	sphere {
		name = shot == 1 and "ball" or "ball " .. shot, radius = .55, material = "iron", born = 1. * (shot - 1),
		at = { 11 * math.cos(angle), 11 * math.sin(angle), 1.2 }, velocity = { -speed * math.cos(angle), -speed * math.sin(angle), 4.9 * time },
	}
end
