-- Fast rotation near others: passing without contact, and hitting.
local this = case { row = 33, variants = {
	{
		name = "near-spin", title = "Fast spin beside a ball", duration = 20,
		setup = "Two boxes, a cylinder and a capsule spin at 50 rad/s, each 10 mm from a ball that they never touch, and that drifts "
			.. "by 8 mm towards them; in free space, 20 s.",
	}, {
		name = "spinning-rods", title = "Rods that spin into a box", duration = 1.5, runs = 3, slow = true,
		setup = "Twelve rods of 1 m x 60 mm spin at 30 and 60 rad/s about oblique axes, each beside a box, free or fixed, that it "
			.. "hits; restitution 0, .5 and 1, friction .3; in free space.",
	},
} }
scene { title = this.title, duration = this.duration, gravity = { 0, 0, 0 } }

-- Angular momentum of a body about its centre.
local function spin_of(b)
	local w, moment = b.turn:back(b.spin), b.inertia
	return b.turn * vector(moment.x * w.x, moment.y * w.y, moment.z * w.z)
end

if this.name == "near-spin" then
	-- The first three spin about an axis towards the ball, but for a fifth; the last is slender, and its ends pass the ball.
	local drift, radius, gap, rate, spinner, ball = -4e-4, .2, .01, 50, {}, {}
	local kinds = {
		{ box, size = vector(.2, .15, .1), axis = vector(.96, .2, .2) }, { cylinder, size = vector(.1, .2, 0), axis = vector(.96, .2, .2) },
		{ capsule, size = vector(.1, .2, 0), axis = vector(.96, .2, .2) }, { box, size = vector(.02, .03, .4), axis = vector(.1, .99, .1) },
	}
	for i, k in ipairs(kinds) do
		local at, b = vector(0, 10 * (i - 1), 0), { mass = 5, spin = rate / k.axis:norm() * k.axis }
		local reach = k[1] == capsule and k.size.x + k.size.y or k.size:norm()
		b.at = at
		if k[1] == box then b.size = 2 * k.size else b.radius, b.length = k.size.x, 2 * k.size.y end
		spinner[i] = k[1](b)
		ball[i] = sphere { radius = radius, mass = 5, at = at + (reach + radius + gap) * vector(1, 0, 0), velocity = { drift, 0, 0 } }
	end
	local function worst_of(run, f)
		local worst = 0
		for i = 1, 4 do worst = math.max(worst, f(run[spinner[i]], run[ball[i]])) end
		return worst
	end
	expect { "error of angular momentum", below = 1e-12, source = "that at the start, as a vector", worst = true, function(run)
		return worst_of(run, function(b)
			local start = spin_of(b.start)
			return (spin_of(b) - start):norm() / start:norm()
		end)
	end }
	expect { "error of energy", below = 1e-9, source = "energy at the start", worst = true, function(run)
		return worst_of(run, function(b)
			return math.abs(spin_of(b):dot(b.spin) / spin_of(b.start):dot(b.start.spin) - 1)
		end)
	end }
	local way = lab.worst(function(run)
		return worst_of(run, function(_, ball) return (ball.moved - vector(drift * run.time, 0, 0)):norm() end)
	end)
	expect { "error of the balls' way", below = 1e-12, unit = "m", source = "v t: nothing touches them", function(run)
		for i = 1, 4 do -- every rotating body passes half a turn of each component of the attitude
			if math.abs(run[spinner[i]].turn.w) > 1 - 1e-9 then run:fail("nothing turned") end
		end
		return way()
	end }
else
	local fixed, rods, rate, random, rod, other = this.run == 2, 12, ({ 30, 60, 30 })[this.run + 1], lab.splitmix(33 + this.run), {}, {}
	for i = 0, rods - 1 do
		local at = vector(40 * (i % 4), 40 * (i // 4), 0)
		local axis = vector(0, i % 2 == 1 and 1 or -1, 0) + random.vector(.5)
		rod[i] = box { size = { .06, .06, 1 }, mass = 4, at = at, spin = rate / axis:norm() * axis, restitution = .5 * (i % 3),
			friction = .3 }
		other[i] = box { size = { .4, .4, .4 }, mass = not fixed and 10 or nil, at = at + .42 * vector(1, 0, 0), static = fixed,
			q = random.rotation(), friction = .3 }
	end
	-- Angular momentum of a pair about its centre of mass.
	local function momentum_of(a, b)
		local mass = a.mass + b.mass
		local centre, v = a.mass * a.at + b.mass * b.at, a.mass * a.velocity + b.mass * b.velocity
		local function part(c)
			local arm, u = c.at + -1 / mass * centre, c.velocity + -1 / mass * v
			return spin_of(c) + c.mass * arm:cross(u)
		end
		return part(a) + part(b)
	end
	local start = {}
	expect { "worst penetration", below = 1, unit = "mm", source = "no penetration", worst = true,
		function(run) return 1e3 * run:penetration() end }
	expect { "gain of energy", below = 1e-9, source = "energy at the start", worst = true, function(run)
		start.energy = start.energy or run.energy
		return run.energy / start.energy - 1
	end }
	local error = lab.worst(function(run)
		local worst = 0
		for i = 0, fixed and -1 or rods - 1 do
			local now = momentum_of(run[rod[i]], run[other[i]])
			start[i] = start[i] or now
			worst = math.max(worst, (now - start[i]):norm() / start[i]:norm())
		end
		return worst
	end)
	expect { "error of angular momentum", below = 1e-9, source = "that of each pair about its centre of mass, at the start",
		function(run)
			for i = 0, rods - 1 do
				if run[rod[i]].moved:norm() < 1e-3 then run:fail("passed through") end
			end
			return error()
		end }
end
