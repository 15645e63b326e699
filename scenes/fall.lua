-- The same fall, twice: with a simulator for each object, and with --arch monolith as one ODE world. A slab of steel drops on
-- crates; the one world, at the same 60 steps a second, lets it sink into them. tools/pictures sets the two side by side.
--   -D title=..      shown by --overlay caption
local title = param("title", "A slab on crates")

scene { title = title, duration = 3 }
sky { top = "#6d8fb5", horizon = "#f2ede4" }
ground { colour = "#7b8790" }
camera "main" { eye = { -3.19, -4.88, 3.49 }, target = { .1, 0, .62 }, fov = 26 }
material "crate" { density = 60, friction = .6, roughness = .8 }
material "steel" { density = 7800, friction = .5, colour = "#aab4bd", roughness = .3, metal = .9 }

local colours = { "#b9824f", "#c79a63", "#a8743f" }
for x = -1, 1 do
	for y = -1, 1 do
		for level = 0, 2 do
			box { material = "crate", size = { .42, .42, .3 }, at = { .62 * x, .62 * y, .15 + .3 * level }, colour = colours[(x + y + level) % 3 + 1] }
		end
	end
end
box { name = "slab", material = "steel", size = { 1.7, 1.7, .2 }, at = { .05, 0, 1.6 }, rotation = { axis = { 1, .3, 0 }, degrees = 4 } }
