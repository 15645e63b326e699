-- A wrecking ball on a chain, and a wall of loose bricks. Each link is a simulator of its own.
local links = param("links", 10, { whole = true })
local rows = param("rows", 6, { whole = true })
scene { title = "A wrecking ball", duration = 8 }
sky { top = "#6f9fd0", horizon = "#e8ecef" }
sun { towards = { -.5, -.8, .9 } }
ground { colour = "#b7ae9c" }
material "brick" { friction = .6, density = 1800, colour = "#b5533c" }
material "steel" { friction = .4, density = 7800, colour = "#4a5058" }
camera "main" { eye = { 5.2, -7.2, 7.4 }, target = { -.6, .2, 2.7 }, fov = 50 }

for row = 0, rows - 1 do
	local odd = row % 2
	for k = 0, 5 - odd do
		box { material = "brick", size = { .25, .58, .28 }, at = { .2, (k - 2.5 + odd / 2) * .6, .14 + row * .28 } }
	end
end

-- The chain hangs from a jib, drawn aside by 65 degrees.
local reach, top, angle = .4, 5.2, 65
local long, x = links * reach + .35, -.6
local sine, cosine = math.sin(math.rad(angle)), math.cos(math.rad(angle))
local function along(s) return { x - s * sine, 0, top - s * cosine } end
box { name = "jib", material = "steel", size = { .3, 3, .3 }, at = { x, 1.2, top + .15 }, static = true }
box { material = "steel", size = { .4, .4, top + .3 }, at = { x, 2.9, (top + .3) / 2 }, static = true }
for i = 1, links do
	capsule {
		name = "link" .. i, material = "steel", radius = .04, length = reach - .08, at = along((i - .5) * reach),
		rotation = { axis = { 0, 1, 0 }, degrees = angle },
	}
	ball { "link" .. i, i > 1 and "link" .. i - 1 or "jib", at = along((i - 1) * reach) }
end
sphere { name = "ball", material = "steel", radius = .35, at = along(long) }
ball { "ball", "link" .. links, at = along(links * reach) }
