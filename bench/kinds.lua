-- Small random scenes of each kind, drawn by the seed: regret.py measures the control of errors by them.
--   -D kind=heap   which
local kinds, names = {}, {}

local function any(list)
	return list[math.random(#list)]
end

local function flat(degrees)
	return { axis = { 0, 0, 1 }, degrees = degrees }
end

local function body(at, more)
	local fields, size = { at = at, q = random_rotation() }, random(.1, .3)
	for name, value in pairs(more or {}) do
		fields[name] = value
	end
	local shape = math.random(4)
	if shape == 1 then
		fields.size = { size, size * random(.5, 1.5), size * random(.5, 1.5) }
		return box(fields)
	elseif shape == 2 then
		fields.radius = size / 2
		return sphere(fields)
	end
	fields.radius, fields.length = size / 2, size * random(.5, 1.5)
	return (shape == 3 and capsule or cylinder)(fields)
end

local function bodies(n, more)
	for i = 1, n do
		body({ random(-.4, .4), random(-.4, .4), .4 + .5 * i }, more)
	end
end

function kinds.heap()
	ground {}
	bodies(8)
end

function kinds.bounce()
	ground { restitution = random(.2, .9) }
	bodies(4)
end

function kinds.hits() -- without gravity
	for i = 1, 5 do
		local away = vector(random(-1, 1), random(-1, 1), random(-1, 1))
		body((.6 * i / away:norm()) * away, { velocity = -random(.3, 1) * away, spin = { random(-3, 3), 0, random(-3, 3) } })
	end
end

function kinds.stack()
	ground {}
	local height, top = random(.1, .3), 0
	for i = 1, math.random(4, 8) do
		box { size = { .4, .4, height }, at = { random(-.03, .03), random(-.03, .03), top + height / 2 }, rotation = flat(random(-20, 20)) }
		top = top + height + any { 0, .001 }
	end
end

function kinds.slide()
	ground { friction = random(.1, .6) }
	for i = 1, 4 do
		local size = { random(.2, .5), random(.2, .5), random(.05, .2) }
		box { size = size, at = { 0, i, size[3] / 2 }, velocity = { random(.5, 3), 0, 0 }, spin = { 0, 0, random(-5, 5) } }
	end
end

function kinds.roll()
	ground {}
	for i = 1, 3 do
		local r, v = random(.05, .3), random(.3, 3)
		sphere { radius = r, at = { 0, i, r }, velocity = { v, 0, 0 }, spin = { 0, any { 0, v / r }, random(-2, 2) } }
		cylinder { radius = r, length = r, at = { 0, -i, r }, rotation = { axis = { 1, 0, 0 }, degrees = 90 }, velocity = { v, 0, 0 },
			spin = { 0, any { 0, v / r }, 0 } }
	end
end

function kinds.disk()
	ground {}
	local r, lean = random(.05, .5), math.rad(random(5, 40))
	cylinder { radius = r, length = .1 * r, at = { 0, 0, r * math.cos(lean) + .05 * r * math.sin(lean) + .0005 }, density = 2000,
		q = rotation(vector(lean - math.pi / 2, 0, 0)), velocity = { random(.5, 2), 0, 0 },
		spin = { 0, random(1, 6), random(-2, 2) } }
end

function kinds.dominoes()
	ground { friction = random(.2, .6) }
	local gap, n = random(.08, .2), math.random(5, 9)
	for i = 1, n do
		box { size = { .05, .2, .4 }, at = { gap * i, random(-.01, .01), .2 }, restitution = any { 0, .1 } }
	end
	sphere { radius = .08, at = { -.3, 0, .3 }, velocity = { random(1, 3), 0, 0 } }
end

function kinds.rock()
	ground { friction = random(.4, .9) }
	for i = 1, 3 do
		local slender, lean = random(2, 8), math.rad(random(1, 5))
		local height, width = .5, .5 / slender
		local q = rotation(vector(0, lean, 0))
		box { size = { width, .3, height }, at = q * vector(-width / 2, 0, height / 2) + vector(0, i, 0), q = q }
	end
end

function kinds.rollers()
	ground {}
	local r, n = random(.05, .12), math.random(3, 5)
	for i = 1, n do
		cylinder { radius = r, length = .5, at = { .3 * i, 0, r }, rotation = { axis = { 1, 0, 0 }, degrees = 90 } }
	end
	box { size = { .3 * n, .4, .08 }, at = { .15 * (n + 1), 0, 2 * r + .04 }, velocity = { random(.2, 1), 0, 0 } }
end

function kinds.car()
	ground { friction = random(.5, 1) }
	local r = random(.08, .15)
	box { name = "car", size = { .8, .3, .1 }, at = { 0, 0, r + .05 }, mass = 20 }
	for i, x in ipairs { -.3, .3 } do
		for k, y in ipairs { -.22, .22 } do
			local name = "wheel " .. i .. k
			cylinder { name = name, radius = r, length = .08, at = { x, y, r }, rotation = { axis = { 1, 0, 0 }, degrees = 90 }, mass = 2 }
			hinge { name, "car", at = { x, y, r }, axis = { 0, 1, 0 }, motor = i == 1 and { rate = random(2, 10), most = 3 } or nil }
		end
	end
end

function kinds.chain()
	local last, n = nil, math.random(2, 6)
	local tilt = rotation(vector(0, random(.3, 2.5), 0))
	for i = 1, n do
		local name = "link " .. i
		box { name = name, size = { .05, .05, .3 }, at = tilt * vector(0, 0, -.3 * (i - .5)), q = tilt }
		ball { name, last, at = tilt * vector(0, 0, -.3 * (i - 1)) }
		last = name
	end
end

function kinds.top()
	local lean, spin = math.rad(random(5, 80)), random(60, 240)
	local axis = vector(math.sin(lean), 0, math.cos(lean))
	cylinder { name = "top", radius = .1, length = .02, mass = 1, at = .2 * axis, q = rotation(vector(0, lean, 0)), spin = spin * axis }
	ball { "top", at = { 0, 0, 0 } }
end

function kinds.planks()
	ground {}
	local gap, across, high = any { 0, .0001, .0005 }, .24, any { .0078, .02, .08 }
	local jitter = any { 0, .0002, .0005 }
	for layer = 0, 9 do
		for side = -1, 1, 2 do
			local at, size = { 0, .1 * side, (layer + .5) * high + (layer + 1) * gap }, { across, .024, high }
			if layer % 2 == 1 then
				at[1], at[2], size[1], size[2] = at[2], 0, size[2], size[1]
			end
			at[1], at[2] = at[1] + random(-jitter, jitter), at[2] + random(-jitter, jitter)
			box { size = size, at = at, density = 600 }
		end
	end
end

function kinds.table()
	box { kind = "kinematic", size = { 3, 3, .2 }, at = { 0, 0, -.1 }, friction = random(.3, .9),
		path = { kind = "sine", amplitude = { random(.02, .1), 0, 0 }, frequency = random(.5, 3) } }
	for i = 1, 3 do
		body({ .6 * i - 1.2, 0, .4 })
	end
end

function kinds.belt()
	box { static = true, size = { 6, 2, .2 }, at = { 0, 0, -.1 }, surface_velocity = { random(.3, 2), 0, 0 } }
	for i = 1, 3 do
		local size = random(.1, .3)
		box { size = { size, size, size }, at = { .6 * i - 1.2, random(-.3, .3), size / 2 + .01 }, rotation = flat(random(0, 90)) }
	end
end

function kinds.wall()
	ground {}
	for row = 0, 3 do
		for column = 0, 3 do
			box { size = { .3, .5, .3 }, at = { 0, (column - 1.5) * .52, .15 + row * .3 }, density = 500 }
		end
	end
	sphere { radius = .3, at = { -2, random(-.5, .5), .6 }, velocity = { random(3, 12), 0, 1 }, density = 2000 }
end

for name in pairs(kinds) do
	names[#names + 1] = name
end
table.sort(names)
local kind = param("kind", "heap", names)
scene { title = kind, duration = 3, gravity = kind == "hits" and { 0, 0, 0 } or nil }
kinds[kind]()
