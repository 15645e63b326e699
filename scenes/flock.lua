-- A flock of birds that keep together and apart, circle a tower, bank as they turn, flush red where they touch something; and
-- a fountain whose drops are made and taken away while the run goes on. A bird is a compound: its trunk, two wings and a
-- tail collide as they look. Best seen live: obsim serve scenes/flock.lua
--   -D wings=false      capsules in place of birds, as the one ODE world (--arch monolith) has no compounds
local n = param("n", 60, { whole = true, min = 1, max = 2000, label = "birds" })
local wings = param("wings", true)

scene { title = "Flock", duration = 20, seed = 7, room = 80 }
sky { top = "#5b8fc7", horizon = "#f4e7d3" }
ground { colour = "#8fa37a", grid = false }
sun { towards = { -.6, -.4, .8 } }
camera "main" { eye = { -6.72, -9.84, 8.88 }, target = { 0, .4, 2.9 }, fov = 44 }

material "feathers" { friction = .2, restitution = .4, density = 120, roughness = .7 }
material "stone" { friction = .7, density = 2400, colour = "#b9b2a4" }

script "flock/bird.lua"
script "flock/fountain.lua"
script "flock/drop.lua"

-- A tower to circle, of blocks that a bird can knock off.
for i = 0, 4 do
	box { size = { 1.6, 1.6, .8 }, at = { 0, 0, .4 + .8 * i }, rotation = { axis = { 0, 0, 1 }, degrees = 9 * i },
	      material = "stone" }
end

-- The beak points along x, the back along z. A sheet has a thickness that one does not see from afar.
local function sheet(...)
	local points = {}
	for _, p in ipairs { ... } do
		points[#points + 1] = { p[1], p[2], p[3] - .008 }
		points[#points + 1] = { p[1], p[2], p[3] + .008 }
	end
	return { points = points }
end

local trunk = {} -- a spindle
for _, ring in ipairs { { -.2, .02 }, { -.1, .05 }, { .02, .068 }, { .1, .055 }, { .17, .035 } } do
	for k = 1, 8 do
		local turn = math.pi * k / 4
		trunk[#trunk + 1] = { ring[1], ring[2] * math.cos(turn), ring[2] * math.sin(turn) }
	end
end
trunk[#trunk + 1] = { .26, 0, -.012 }

local bird = { { points = trunk }, sheet({ -.12, 0, .01 }, { -.33, -.09, .02 }, { -.33, .09, .02 }) }
for _, side in ipairs { -1, 1 } do -- an arm that rises, and a hand that is swept back
	bird[#bird + 1] = sheet({ .1, 0, .03 }, { -.1, 0, .03 }, { .13, .24 * side, .12 }, { -.08, .22 * side, .12 })
	bird[#bird + 1] = sheet({ .13, .24 * side, .12 }, { -.08, .22 * side, .12 }, { -.06, .58 * side, .1 }, { -.09, .56 * side, .1 })
end

for i = 1, n do
	local angle, r = 2 * math.pi * i / n, random(5, 9)
	local one = { name = "bird " .. i, at = { r * math.cos(angle), r * math.sin(angle), random(2, 5) },
	              rotation = { axis = { 0, 0, 1 }, degrees = 360 * i / n + 90 },
	              velocity = { -3 * math.sin(angle), 3 * math.cos(angle), 0 }, material = "feathers",
	              colour = "#3f7cac", script = "flock/bird.lua", state = { height = random(2, 5) } }
	if wings then
		one.parts = bird
		compound(one)
	else
		one.radius, one.length = .12, .3
		capsule(one)
	end
end

cylinder { name = "fountain", radius = .5, length = .4, at = { 7, -3, .2 }, static = true, material = "stone",
           script = "flock/fountain.lua" }
