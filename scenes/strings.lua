-- Newton's cradle on strings: as many balls as come in leave at the other end, while the rest hang still. Balls and strings
-- are simulators; a string is a light rod, held by a ball joint at the rail and by one in the middle of its ball.
--   -D lifted=2      balls, 1 to 4
--   -D degrees=40    by which they are lifted
local lifted = param("lifted", 2, { whole = true, min = 1, max = 4, label = "lifted balls" })
local degrees = param("degrees", 40.0, { min = 1, max = 80, label = "angle", unit = "°" })

scene { title = "Newton's cradle on strings", duration = 10 }
sky { top = "#6d8fb5", horizon = "#f2ede4" }
sun { towards = { -.5, -.7, 1 } }
ground { colour = "#5d7282", grid = false }
material "steel" { friction = 0, restitution = 1, density = 7850, colour = "#d8dde3", roughness = .12, metal = 1 }
material "brass" { friction = .4, density = 8500, colour = "#c69a4e", roughness = .4, metal = .3 }
material "thread" { density = 1000, colour = "#fbf8f0", roughness = .9 }
material "wood" { friction = .5, density = 700, colour = "#8a5a35" }
camera "main" { eye = { -.74, -2.42, 1.67 }, target = { 0, 0, .44 }, fov = 33 }

local radius, high, deep, string = .1, .95, .3, .62 -- m; string: from the rails' height to the balls' middle
local reach = math.sqrt(deep ^ 2 + string ^ 2)

box { material = "wood", size = { 1.5, .8, .08 }, at = { 0, 0, .04 }, static = true }
for side = -1, 1, 2 do
	capsule { name = side < 0 and "front" or "back", material = "brass", radius = .018, length = 1.24, at = { 0, side * deep, high },
	          rotation = { axis = { 0, 1, 0 }, degrees = 90 }, static = true }
	for _, x in ipairs { -.62, .62 } do
		capsule { material = "brass", radius = .018, length = high - .08, at = { x, side * deep, (high + .08) / 2 }, static = true }
	end
end

for i = 1, 5 do
	local angle = i <= lifted and math.rad(degrees) or 0
	local x, aside, down = (i - 3) * 2 * radius, -string * math.sin(angle), string * math.cos(angle)
	sphere { name = "ball " .. i, material = "steel", radius = radius, at = { x + aside, 0, high - down } }
	for side = -1, 1, 2 do
		local rail, name = side < 0 and "front" or "back", "string " .. i .. (side < 0 and " in front" or " behind")
		local function along(share) return { x + share * aside, side * deep * (1 - share), high - share * down } end
		capsule { name = name, material = "thread", radius = .005, length = reach - radius - .01, mass = .01,
		          at = along((1 - radius / reach) / 2), -- from the rail to the ball's surface
		          rotation = { axis = { -side * deep, -aside, 0 }, degrees = math.deg(math.acos(down / reach)) } }
		ball { name, rail, at = along(0) }
		ball { name, "ball " .. i, at = along(1) }
	end
end
