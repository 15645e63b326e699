-- Driven machines, which move the same under any load: two belts, a lift, a turntable, a shaking table, a paddle.
local speed = param("speed", 1.2, { min = 0, max = 5, label = "speed of the belts", unit = "m/s" })
local rate = param("rate", 2.2, { min = 0, max = 20, label = "speed of the turntable", unit = "rad/s" })
local shakes = param("shakes", 1.25, { min = .01, max = 20, label = "shakes", unit = "Hz" })

scene { title = "Machines", duration = 8 }
material "machine" { friction = .6, colour = "#59636e" }
material "rubber" { friction = .8, colour = "#2b2f33" }
material "crate" { friction = .6, density = 400, colour = "#c08a53" }
material "stone" { friction = .6, density = 2400, colour = "#8d99ae" }
ground { colour = "#cfcac0" }
camera "main" { eye = { .99, -9.33, 5.36 }, target = { .5, .2, .5 }, fov = 40 }

-- Crates ride along two belts, one above the other's end.
box { name = "belt", static = true, material = "rubber", size = { 4, .9, .16 }, at = { -3.6, 2, 1.4 }, surface_velocity = { speed, 0, 0 } }
box { name = "lower belt", static = true, material = "rubber", size = { 4, 1.1, .16 }, at = { -.3, 2, .62 }, surface_velocity = { speed, 0, 0 } }
for _, x in ipairs { -5.3, -2, -2.2, 1.4 } do
	box { static = true, material = "machine", size = { .12, .8, x < -2.1 and 1.32 or .54 }, at = { x, 2, x < -2.1 and .66 or .27 } }
end
for i = 0, 4 do
	box { material = "crate", size = { .36, .36, .36 }, at = { -5.3 + .68 * i, 2 + random(-.12, .12), 1.66 }, rotation = { axis = { 0, 0, 1 }, degrees = random(-20, 20) } }
end

-- A lift takes a pile up, waits, and comes down again.
box {
	name = "lift", kind = "kinematic", material = "machine", size = { 1.7, 1.7, .14 }, at = { 4.9, 1.6, .08 },
	path = { kind = "spline", loop = true, points = { { 0, 0, 0, 0 }, { .5, 0, 0, 0 }, { 2.5, 0, 0, 1.9 }, { 4, 0, 0, 1.9 }, { 6, 0, 0, 0 }, { 7, 0, 0, 0 } } },
}
for row = 0, 2 do
	for column = 0, 2 - row do
		box { material = "crate", size = { .42, .6, .42 }, at = { 4.9 + (column - (2 - row) / 2) * .44, 1.6, .15 + .21 + .42 * row } }
	end
end

-- A turntable keeps bodies near its axis, and throws off others.
cylinder { name = "turntable", kind = "kinematic", material = "machine", radius = 1.5, length = .3, at = { -3.3, -1.3, .45 }, spin = { 0, 0, rate } }
cylinder { static = true, material = "machine", radius = .3, length = .3, at = { -3.3, -1.3, .15 } }
for i = 0, 5 do
	local r, angle = .35 + .2 * i, 2.4 * i
	local x, y = r * math.cos(angle), r * math.sin(angle)
	box {
		material = "stone", size = { .22, .22, .16 }, at = { -3.3 + x, -1.3 + y, .68 },
		velocity = { -rate * y, rate * x, 0 }, spin = { 0, 0, rate }, rotation = { axis = { 0, 0, 1 }, degrees = math.deg(angle) },
	}
end

-- A shaking table: tall bodies fall over, flat ones slide, round ones roll.
box {
	name = "shaking table", kind = "kinematic", material = "machine", size = { 2.4, 1.8, .16 }, at = { .4, -1.5, .5 },
	path = { kind = "sine", amplitude = { .11, 0, 0 }, frequency = shakes },
}
for i, height in ipairs { .25, .5, .8, 1.1 } do
	box { material = "stone", size = { .26, .26, height }, at = { -.45 + .55 * (i - 1), -1.15, .58 + height / 2 } }
end
for i = 0, 2 do
	cylinder { material = "crate", radius = .16, length = .5, at = { -.2 + .6 * i, -1.9, .74 }, rotation = { axis = { 1, 0, 0 }, degrees = 90 } }
end

-- A paddle goes round and bats balls away.
box {
	name = "paddle", kind = "kinematic", material = "machine", size = { .16, .7, .5 }, at = { 4.4, -1.4, .27 },
	path = { kind = "circle", centre = { 3.4, -1.4, .27 }, frequency = .4 }, spin = { 0, 0, .8 * math.pi },
}
for i = 0, 5 do
	local angle = 1 + .85 * i
	sphere { radius = .16, density = 700, restitution = .6, friction = .3, at = { 3.4 + math.cos(angle), -1.4 + math.sin(angle), .16 } }
end
