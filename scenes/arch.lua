-- An arch of loose stones, without mortar, that stands as long as a line of thrust fits into it: with twenty stones and
-- a radius of 5 m, from a thickness of .5368 m on (obsim lab arch-stands arch-falls).
--   -D thickness=.5   m: too thin, it falls
--   -D n=20           how many stones
local n = param("n", 20, { whole = true, min = 4, max = 200, label = "stones" })
local thickness = param("thickness", .55, { min = .01, max = 4, unit = "m" })
local radius, depth = 5, 1

scene { title = "An arch of " .. n .. " stones", duration = 6 }
material "stone" { density = 2400, friction = .9, restitution = 0 }
ground { friction = .9 }
camera "main" { eye = { 5.13, -12.13, 8.53 }, target = { 0, 0, 2.1 } }

for i = 0, n - 1 do
	local points = {}
	for _, angle in ipairs { math.pi * i / n, math.pi * (i + 1) / n } do
		for _, r in ipairs { radius - thickness / 2, radius + thickness / 2 } do
			for _, y in ipairs { -depth / 2, depth / 2 } do
				points[#points + 1] = { r * math.cos(angle), y, r * math.sin(angle) }
			end
		end
	end
	hull { points = points, at = { 0, 0, 0 }, material = "stone", colour = i % 2 == 0 and "#b8a88a" or "#93836a" }
end
