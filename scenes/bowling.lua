-- A strike, perhaps. The pins look like pins and collide as their convex hulls, the lane is a box, the ball a sphere;
-- bowling/make.py writes their meshes, bowling/*.glb.
--   obsim run bowling.lua --quality fine --out bowling.mp4
local speed = param("speed", 7.5, { min = .1, max = 30, unit = "m/s" })
local inch = .0254

scene { title = "Bowling", duration = 4 }
material "wood" { friction = .2, restitution = .1 }
material "maple" { friction = .25, restitution = .4 }
material "resin" { friction = .1, restitution = .3 }
material "gutter" { friction = .3, restitution = .1, colour = "#55585f", roughness = .35 }
material "curtain" { friction = .8, restitution = 0, colour = "#8d8296", roughness = .9 }
material "panel" { colour = "#b8463f", roughness = .5, pattern = "planks" }
material "wall" { friction = .8, restitution = 0, colour = "#8d8296", roughness = .9, pattern = "bricks" }
camera "main" { eye = { -6.8, -3, 4.1 }, target = { .1, 0, .2 }, fov = 46 }
camera "pins" { eye = { -.75, -1.25, .75 }, target = { 1.5, .02, .13 }, fov = 30 }
camera "behind" { eye = { -4.4, 0, .9 }, target = { 1, 0, .1 }, fov = 26 }
camera "hall" { eye = { -5.6, -1.1, 1.5 }, target = { 1.2, .05, .35 }, fov = 36 }
sky { top = "#5a5262", horizon = "#a89aa6" }
sun { towards = { -.93, -.33, .4 } } -- low, so that it shines into the pit
ground { colour = "#4c4850", grid = false }

-- Three lanes with gutters between them, and behind the pins a pit with a curtain, under a panel.
local wide, apart = 1.05, 1.45 -- m: of a lane; from one to the next
for k = -1, 1 do
	box { name = ({ "right lane", "lane", "left lane" })[k + 2], size = { 6, wide, .1 }, at = { 0, k * apart, .05 },
		static = true, material = "wood", mesh = "bowling/lane.glb" }
end
for k = -1.5, 1.5 do
	box { size = { 6, apart - wide, .03 }, at = { 0, k * apart, .015 }, static = true, material = "gutter" }
end
box { name = "curtain", size = { .1, 4 * apart, 1.1 }, at = { 3.75, 0, .55 }, static = true, material = "curtain" }
box { name = "panel", size = { .1, 4 * apart, .65 }, at = { 3, 0, 1.475 }, static = true, material = "panel" }
for k = -1.5, 1.5, 3 do
	box { size = { 1.6, .06, .9 }, at = { 2.95, k * apart, .45 }, static = true, material = "wall" }
end

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
