-- An avalanche: thousands of stones come down a slope between rocks, into a village of loose bricks. Not meant for real
-- time: the default takes a workstation minutes; -D n=1000 is quicker.
--   -D n=10000        stones
--   -D slope=31       degrees
local n = param("n", 10000, { whole = true, min = 1, max = 100000, label = "stones" })
local slope = param("slope", 31, { min = 5, max = 60, unit = "°" })
local a = math.rad(slope)
local up = { math.sin(a), 0, math.cos(a) } -- normal of the slope, which comes down towards +x

scene { title = "Avalanche of " .. n .. " stones", duration = 12, tolerance = .02 }
ground { colour = "#a5b083", grid = false }
plane { name = "slope", normal = up, at = { 0, 0, 0 }, friction = .3, colour = "#98a3ad" }
sky { top = "#4f86c0", horizon = "#e7eff5" }
sun { towards = { .45, -.75, .55 } }
material "stone" { friction = .45, restitution = .1, density = 2500 }
material "rock" { friction = .7, density = 2600, colour = "#5d6068" }
material "brick" { friction = .6, density = 1600 }
camera "main" { eye = { 31, -28, 32 }, target = { -8.5, 0, 6 }, fov = 46 }
camera "foot" { eye = { 15.8, 1.2, 3.5 }, target = { -2, -.4, 3.1 }, fov = 44 }
camera "village" { eye = { 17, -7, 3.2 }, target = { 4, 0, 1 }, fov = 45 }

-- A place on the slope: d m up from its foot, y across, h m above it.
local function on_slope(d, y, h)
	return { -d * math.cos(a) + h * up[1], y, d * math.sin(a) + h * up[3] }
end
local function leaning(degrees)
	return { axis = { 0, 1, 0 }, degrees = degrees }
end

for _, p in ipairs { { 16, -3.2, 1.5 }, { 13, 2.4, 1.2 }, { 9.5, -.6, 1 }, { 8, 5.2, 1.4 }, { 7, -6, 1.3 }, { 19, 5, 1.7 }, { 21, -7, 1.6 } } do
	box { static = true, material = "rock", size = { p[3], p[3], 1.9 * p[3] }, at = on_slope(p[1], p[2], .4), rotation = leaning(slope + 12 * p[3]) }
end
for _, y in ipairs { -10.5, 10.5 } do
	box { static = true, material = "rock", size = { 46, .6, 2.4 }, at = on_slope(22, y, .6), rotation = leaning(slope) }
end

-- Stones fill a block above the slope, from the bottom up.
local across = 42
local palette = { "#7f848c", "#8f949b", "#a7abb0", "#6c7078", "#bcc0c4", "#77706a", "#938a80" }
for i = 0, n - 1 do
	local y, k = i % across, i // across
	local along, layer = k % 38, k // 38
	local at = on_slope(23 + .44 * along + random(-.05, .05), (y - (across - 1) / 2) * .44 + random(-.05, .05), .3 + .44 * layer)
	local colour = palette[1 + math.floor(random(0, #palette))]
	if i % 3 == 0 then
		sphere { radius = random(.13, .2), at = at, material = "stone", colour = colour }
	else
		box { size = { random(.2, .27), random(.2, .27), random(.16, .21) }, at = at, q = random_rotation(), material = "stone", colour = colour }
	end
end

-- Houses of loose bricks with a slab for a roof.
local function house(x, y, colour)
	for row = 0, 5 do
		local shift = row % 2 * .25
		for k = -1, 1 do
			box { size = { .5, .24, .25 }, at = { x + k * .5 + shift - .125, y - .7, .125 + .25 * row }, material = "brick", colour = colour }
			box { size = { .5, .24, .25 }, at = { x + k * .5 + shift - .125, y + .7, .125 + .25 * row }, material = "brick", colour = colour }
		end
		box { size = { .24, 1.1, .25 }, at = { x + .93, y, .125 + .25 * row }, material = "brick", colour = colour }
		box { size = { .24, 1.1, .25 }, at = { x - .93, y, .125 + .25 * row }, material = "brick", colour = colour }
	end
	box { size = { 2.5, 2, .16 }, at = { x, y, 1.58 }, material = "brick", colour = "#7a2e22" }
end
house(5, -4, "#c96f4a")
house(7.5, 0, "#d9a066")
house(5.5, 4.2, "#b85c45")
house(10.5, -3, "#d08c60")
house(11, 3.2, "#c77c58")
