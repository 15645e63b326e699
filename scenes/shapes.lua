-- Shapes: all kinds of objects in a scene. Spheres, boxes, capsules and cylinders rain on a ramp before a slope. Some
-- are born while others already lie, and the gate at the foot of the ramp is taken away after three seconds.
--   -D n=48    how many fall
local n = param("n", 48, { whole = true, min = 0, max = 10000, label = "objects that fall" })

scene { title = "Shapes", duration = 12, gravity = { 0, 0, -9.81 }, step = 1 / 60 }

material "wood" { friction = .6, density = 600, colour = "#c08a53" }
material "rubber" { friction = .9, restitution = .7, density = 1100, colour = "#d1495b" }
material "steel" { friction = .2, restitution = .3, density = 7850, colour = "#c3c9d0" }
material "stone" { friction = .7, density = 2400, colour = "#8f958c" }

sky { top = "#4f86c0", horizon = "#e3edf4" }
sun { towards = { -.8, -.3, .75 } }
ground { friction = .6, grid = true }

camera "main" { eye = { -5.84, -9.49, 7.57 }, target = { -1.1, 0, 2.4 }, fov = 44 }
camera "orbit" { eye = { 0, -15, 5 }, target = { 0, 0, 1 }, pan = 6 }
camera "above" { from = { 0, -.05, 1 } }

-- A ramp with a gate at its foot, and a slope far behind.
box {
	name = "ramp", static = true, material = "stone", friction = .05,
	size = { 6, 3, .3 }, at = { -2, 0, 1.6 }, rotation = { axis = { 0, 1, 0 }, degrees = 22 },
}
box { name = "gate", static = true, material = "steel", size = { .15, 3, 1.2 }, at = { .95, 0, 1.1 }, dies = 3 }
plane { name = "slope", normal = { -1, 0, .35 }, at = { 16, 0, 0 }, friction = .6, colour = "#a9aea8" }

local make = {
	function(f) f.material, f.radius = "rubber", .22; sphere(f) end,
	function(f) f.material, f.size = "wood", { .5, .4, .3 }; box(f) end,
	function(f) f.material, f.radius, f.length = "steel", .14, .5; capsule(f) end,
	function(f) f.material, f.radius, f.length = "wood", .2, .45; cylinder(f) end,
}

for i = 0, n - 1 do
	make[i % #make + 1] {
		at = { -3.8 + .9 * (i % 3), -.9 + .9 * (i // 3 % 3), 4 + .8 * (i // 9 % 3) },
		q = random_rotation(),
		spin = { random(-2, 2), random(-2, 2), random(-2, 2) },
		born = 1.5 * (i // 27), -- the next shower, once the one before has fallen out of the way
	}
end

record { every = 2 }
