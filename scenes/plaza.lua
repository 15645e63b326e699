-- A plaza where people walk about, push crates and greet each other: a script each, a simulator each. They stand by
-- torques and walk by forces, so that crates and collisions act on them as on any body.
-- `obsim serve plaza` gives each visitor a person to steer: W A S D, and E to greet.
--   -D people=20
--   -D crates=60
local people = param("people", 20, { whole = true, min = 0, max = 500 })
local crates = param("crates", 60, { whole = true, min = 0, max = 1000 })

scene { title = "A plaza", duration = 60, seed = 3 }
ground { colour = "#c7b9a1" }
sky { top = "#5a95d2", horizon = "#f3e7d3" }
sun { towards = { -.75, -.35, .7 } }
material "person" { friction = .08, density = 350, restitution = 0 }
material "crate" { friction = .45, density = 45 }
material "stone" { friction = .6, colour = "#a79c8c" }
material "leaf" { friction = .5, roughness = .95, colour = "#4d7d3a" }
material "wood" { friction = .5, colour = "#6f4e37" }
camera "main" { eye = { -10.19, -10.19, 7.88 }, target = { .2, .2, .4 }, fov = 42 }
camera "behind" { on = "visitor", eye = { -3.4, 0, 1.5 }, target = { 1.5, 0, .3 }, fov = 60 }
camera "eyes" { on = "person 1", eye = { -2.6, 0, 1.3 }, target = { 2, 0, .3 }, fov = 60 }
script "plaza/person.lua"

-- A fountain, trees in tubs, benches, a gate of columns.
cylinder { static = true, material = "stone", radius = 1.7, length = .36, at = { 0, 0, .18 } }
cylinder { static = true, radius = 1.45, length = .4, at = { 0, 0, .2 }, colour = "#3f8fb5", roughness = .1 }
cylinder { static = true, material = "stone", radius = .28, length = 1.5, at = { 0, 0, .75 } }
cylinder { static = true, material = "stone", radius = .8, length = .16, at = { 0, 0, 1.5 } }
sphere { static = true, radius = .24, at = { 0, 0, 1.76 }, colour = "#d8b24a", metal = 1, roughness = .25 }
for k = 0, 7 do
	local angle = math.pi / 8 + k * math.pi / 4
	local x, y = 8.6 * math.cos(angle), 8.6 * math.sin(angle)
	cylinder { static = true, material = "stone", radius = .6, length = .5, at = { x, y, .25 } }
	cylinder { static = true, material = "wood", radius = .12, length = 1.7, at = { x, y, 1.2 } }
	sphere { static = true, material = "leaf", radius = .85, at = { x, y, 2.6 } }
	sphere { static = true, material = "leaf", radius = .6, at = { x + .25, y - .2, 3.3 }, colour = "#5e8f46" }
end
for k = 0, 3 do
	local angle = k * math.pi / 2
	box { static = true, material = "wood", size = { .5, 2, .12 }, at = { 6.6 * math.cos(angle), 6.6 * math.sin(angle), .46 }, rotation = { axis = { 0, 0, 1 }, degrees = 90 * k } }
	for side = -1, 1, 2 do
		box { static = true, material = "stone", size = { .4, .2, .4 }, at = { 6.6 * math.cos(angle) - side * .8 * math.sin(angle), 6.6 * math.sin(angle) + side * .8 * math.cos(angle), .2 }, rotation = { axis = { 0, 0, 1 }, degrees = 90 * k } }
	end
end
for k = -3, 3 do
	cylinder { static = true, material = "stone", radius = .32, length = 4, at = { 2.6 * k, 11.5, 2 }, colour = "#d9cdb8" }
end
box { static = true, material = "stone", size = { 17, 1, .6 }, at = { 0, 11.5, 4.3 }, colour = "#cfc2ac" }

local placed = { { 0, 0, 2.2 }, { 6.6, 0, 1.2 }, { -6.6, 0, 1.2 }, { 0, 6.6, 1.2 }, { 0, -6.6, 1.2 } } -- x, y, radius
for k = 0, 7 do
	local angle = math.pi / 8 + k * math.pi / 4
	placed[#placed + 1] = { 8.6 * math.cos(angle), 8.6 * math.sin(angle), .7 }
	placed[#placed + 1] = { 2.6 * (k - 3), 11.5, .6 }
end
local function free_place(low, high, radius)
	for _ = 1, 400 do
		local angle, r = random(0, 2 * math.pi), random(low, high)
		local x, y, free = r * math.cos(angle), r * math.sin(angle), true
		for _, p in ipairs(placed) do
			free = free and (x - p[1]) ^ 2 + (y - p[2]) ^ 2 > (radius + p[3]) ^ 2
		end
		if free then
			placed[#placed + 1] = { x, y, radius }
			return x, y
		end
	end
end

local wares = { "#b5793f", "#c98d4b", "#8f5b32", "#a9804f" }
for i = 1, crates do
	local x, y = free_place(2.4, math.max(5.8 + crates / 80, .84 * math.sqrt(crates)), .42)
	if x then
		local size = random(.36, .56)
		box { size = { size, size, size }, at = { x, y, size / 2 }, material = "crate", rotation = { axis = { 0, 0, 1 }, degrees = random(0, 90) }, colour = wares[1 + i % #wares] }
	end
end
capsule {
	avatar = true, name = "visitor", radius = .24, length = 1.2, at = { -3.6, -3.6, .84 }, material = "person", colour = "#f2f4f6",
	script = "plaza/person.lua", state = { colour = "#f2f4f6", speed = 1.5, far = 8, led = true, vx = 0, vy = 0 },
}
controls { key = "w", label = "Ahead", sends = "go", values = { 1, 0 } }
controls { key = "s", label = "Back", sends = "go", values = { -.6, 0 } }
controls { key = "a", label = "Left", sends = "go", values = { 0, 1 } }
controls { key = "d", label = "Right", sends = "go", values = { 0, -1 } }
controls { key = "e", gamepad = 0, label = "Greet", sends = "greet" }

local coats = { "#3d6fa5", "#a33f3f", "#3f7f5c", "#7a4d8f", "#c08a2d", "#46505c", "#b35f86", "#2f8f96" }
for i = 1, people do
	local x, y = free_place(2.4, 6 + people / 40, .4)
	if x then
		capsule {
			name = "person " .. i, radius = .24, length = 1.2, at = { x, y, .84 }, material = "person", colour = coats[1 + i % #coats],
			script = "plaza/person.lua", state = { colour = coats[1 + i % #coats], speed = random(.8, 1.5), far = 6 + people / 40 },
		}
	end
end
