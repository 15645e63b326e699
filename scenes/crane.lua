-- A gantry crane carries stools to a stack. A stool is a compound of a seat and four legs; the grab's mast is on a slider whose
-- motor lifts it, and its script joins it to a stool, and lets go: joints come and go while the universe runs.
--   -D stools=4      1 to 4
local stools = param("stools", 4, { whole = true, min = 1, max = 4 })

local CYCLE <const> = 11 -- s, to carry a stool and come back
scene { title = "Crane that stacks stools", duration = CYCLE * stools + 1, room = 1 }
sky { top = "#6d8fb5", horizon = "#f2ede4" }
sun { towards = { -.4, -.8, 1 } }
ground { colour = "#8b949a" }
material "steel" { friction = .4, density = 2000, colour = "#c9ced3", roughness = .35, metal = .8 }
material "yellow" { friction = .4, density = 2000, colour = "#f0b429", roughness = .5 }
material "wood" { friction = .6, density = 650, colour = "#b9824f", roughness = .8 }
camera "main" { eye = { -2.28, -4.85, 3.98 }, target = { .1, 0, 1.35 }, fov = 50 }

local high, seat, leg = 2.2, .06, .4 -- m: the rail; thickness of a seat, length of a leg
local stack, first, spacing = 1.9, -2.2, .8 -- m: places along the rail

box { name = "rail", material = "yellow", size = { 5.6, .2, .16 }, at = { 0, 0, high + .2 }, static = true }
for _, x in ipairs { -2.7, 2.7 } do
	for _, y in ipairs { -.7, .7 } do
		box { material = "yellow", size = { .12, .12, high + .2 }, at = { x, y, (high + .2) / 2 }, static = true }
	end
	box { material = "yellow", size = { .12, 1.52, .12 }, at = { x, 0, high + .22 }, static = true }
end

local way = { { 0, 0, 0, 0 } } -- of the trolley, from the first stool
for i = 1, stools do
	local there, back, start = stack - first, i < stools and i * spacing or 0, (i - 1) * CYCLE
	way[#way + 1] = { start + 4.2, (i - 1) * spacing, 0, 0 }
	way[#way + 1] = { start + 6, there, 0, 0 }
	way[#way + 1] = { start + 9.6, there, 0, 0 }
	way[#way + 1] = { start + 11, back, 0, 0 }
end
box { name = "trolley", material = "steel", size = { .4, .4, .14 }, at = { first, 0, high + .04 }, kind = "kinematic",
      path = { kind = "spline", points = way } }
compound { name = "grab", material = "steel", at = { first, 0, high - .2 }, mass = 40, parts = {
	{ size = { .34, .34, .06 } },
	{ size = { .08, .08, 1.76 }, at = { 0, 0, .9 } },
}, script = [[
	function on_start()
		self.state.stool, self.state.stage = 1, "down"
		motor("hoist", -1.2)
		self:wake(.5)
	end

	function on_wake()
		local s, t, _, rate = self.state, time() % 11, joint("hoist")
		local lies = rate > -.1 -- it goes down no further
		local pause = .05
		if s.stage == "down" and lies then
			fixed { "grab", "stool " .. s.stool, name = "grip" }
			motor("hoist", 1.2)
			s.stage = "lifts"
		elseif s.stage == "lifts" and t > 6.1 then
			motor("hoist", -1.2)
			s.stage, pause = "lowers", .5
		elseif s.stage == "lowers" and lies then
			unjoin("grip")
			motor("hoist", 1.2)
			s.stage = "up"
		elseif s.stage == "up" and t < 1 then
			s.stool, s.stage = s.stool + 1, "down"
			if not find("stool " .. s.stool) then return end
			motor("hoist", -1.2)
			pause = .5
		end
		self:wake(pause)
	end
]] }
slider { "grab", "trolley", name = "hoist", axis = { 0, 0, 1 }, low = -high, high = 0, motor = { rate = 0, most = 1500 } }
apart { "grab", "rail" }

for i = 1, stools do
	local parts = { { size = { .5, .5, seat }, at = { 0, 0, leg + seat / 2 } } }
	for x = -1, 1, 2 do
		for y = -1, 1, 2 do
			parts[#parts + 1] = { size = { .06, .06, leg }, at = { .2 * x, .2 * y, leg / 2 } }
		end
	end
	compound { name = "stool " .. i, material = "wood", parts = parts, at = { first + (i - 1) * spacing, 0, 0 },
	           colour = ({ "#b9824f", "#8d5a3a", "#d0a06a", "#a86d3d" })[i] }
end
