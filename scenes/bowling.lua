-- A strike, perhaps. The pins look like pins and collide as their convex hulls, the lane is a box, the ball a sphere;
-- bowling/make.py writes their meshes, bowling/*.glb.
--   obsim run bowling.lua --quality fine --video bowling.mp4
local speed = param("speed", 7.5, { min = .1, max = 30 }) -- m/s
local inch = .0254

scene { title = "Bowling", duration = 4 }
material "wood" { friction = .2, restitution = .1 }
material "maple" { friction = .25, restitution = .4 }
material "resin" { friction = .1, restitution = .3 }
camera "main" { from = { -.9, -.55, .42 }, fov = 30 }
camera "pins" { eye = { -.75, -1.25, .9 }, target = { 1.5, .02, .17 }, fov = 33 }
camera "behind" { eye = { -4.4, 0, .9 }, target = { 1, 0, .1 }, fov = 26 }
ground { colour = "#8d9092", grid = false }

box { name = "lane", size = { 6, 1.05, .1 }, at = { 0, 0, .05 }, static = true, material = "wood", mesh = "bowling/lane.glb" }

-- Heights and diameters in inches at which a pin is a corner of its hull; the neck is hidden in it.
local points = {}
for _, at in ipairs { { 0, 2.031 }, { 2.25, 3.906 }, { 4.5, 4.766 }, { 5.875, 4.563 }, { 13.5, 2.547 }, { 14.7, 1.6 } } do
	for k = 1, 10 do
		local turn = 2 * math.pi * k / 10
		points[#points + 1] = { at[2] / 2 * inch * math.cos(turn), at[2] / 2 * inch * math.sin(turn), (at[1] - 7.5) * inch }
	end
end
for row = 0, 3 do
	for k = 0, row do
		hull { points = points, mass = 1.5, material = "maple", mesh = "bowling/pin.glb",
			at = { 1.2 + row * 12 * inch * math.sqrt(3) / 2, (k - row / 2) * 12 * inch, .1 + 7.5 * inch + .0005 } }
	end
end

sphere { name = "ball", radius = .1085, mass = 7, material = "resin", mesh = "bowling/ball.glb", mesh_scale = .1085,
	at = { -2.6, -.16, .1 + .1085 }, velocity = { speed, .3, 0 }, spin = { 14, speed / .1085, 0 },
	rotation = { axis = { 1, .3, 0 }, degrees = 65 } }
