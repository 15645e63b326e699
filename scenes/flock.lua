-- A flock of birds that keep together and apart, circle a tower, flush red where they touch something; and a fountain
-- whose drops are made and taken away while the run goes on. Best seen live: obsim serve scenes/flock.lua
local n = param("n", 60, { min = 1, max = 2000 })

scene { title = "Flock", duration = 20, seed = 7, room = 80 }
ground { colour = "#8fa37a" }
sun { towards = { -.6, -.4, .8 } }
camera "main" { from = { -.6, -.75, .35 }, fov = 38 }

material "feathers" { friction = .2, restitution = .4, density = 120 }
material "stone" { friction = .7, density = 2400, colour = "#b9b2a4" }

script "flock/bird.lua"
script "flock/fountain.lua"
script "flock/drop.lua"

-- A tower to circle, of blocks that a bird can knock off.
for i = 0, 4 do
	box { size = { 1.6, 1.6, .8 }, at = { 0, 0, .4 + .8 * i }, rotation = { axis = { 0, 0, 1 }, degrees = 9 * i },
	      material = "stone" }
end

for i = 1, n do
	local angle, r = 2 * math.pi * i / n, random(5, 9)
	capsule { name = "bird " .. i, radius = .12, length = .3, at = { r * math.cos(angle), r * math.sin(angle), random(2, 5) },
	          velocity = { -3 * math.sin(angle), 3 * math.cos(angle), 0 }, material = "feathers",
	          colour = "#3f7cac", script = "flock/bird.lua", state = { height = random(2, 5) } }
end

cylinder { name = "fountain", radius = .5, length = .4, at = { 7, -3, .2 }, static = true, material = "stone",
           script = "flock/fountain.lua" }
