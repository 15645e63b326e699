-- Mechanisms that touch: a bridge of planks, ragdolls, a car.
local this = case { variants = {
	{
		name = "plank-bridge", row = 54, title = "Bridge of planks under a load", duration = 20,
		setup = "Nine planks of 2 kg hang by damped hinges between two walls; a box of 10 kg is put on the middle one. Where they "
			.. "are after 20 s.",
	}, {
		name = "ragdoll", row = 55, title = "Ragdolls that fall", duration = 6, runs = 3, sleeps = true,
		setup = "Three ragdolls with limits and dry friction in their joints fall on the ground; 6 s.",
	}, {
		name = "car", row = 56, title = "Car over a rough floor", duration = 8,
		setup = "A car of 84 kg whose four wheels have motors drives over ten bars of 2 to 6 cm; 8 s. All is the same on its left "
			.. "and on its right.",
	},
} }
scene { title = this.title, duration = this.duration }
local g, along_y = 9.81, rotation(math.sqrt(.5), -math.sqrt(.5), 0, 0) -- a frame with z along y
local function holds(judge)
	local gap, depth = lab.worst(function(run) return run.gap end), lab.worst(function(run) return 1e3 * run:penetration() end)
	expect { "gap of a joint", below = 1e-9, unit = "m", source = "its two places are one", function(run)
		judge(run)
		return gap()
	end }
	expect { "worst penetration", below = 1, unit = "mm", source = "none", depth }
end

if this.name == "plank-bridge" then
	local planks, middle, plank, half, span, mass, load = 9, 4, .5, .03, 4.3, 2, 10
	-- Angle of plank k from the middle, hanging with this tension along x: its ends pull at it along its own line.
	local function angle_of(carried, tension, k)
		return k > 0 and math.atan(.5 * (carried + mass) * g + (k - .5) * mass * g, tension) or 0
	end
	local function width(carried, tension)
		local sum = plank
		for k = 1, middle do sum = sum + 2 * plank * math.cos(angle_of(carried, tension, k)) end
		return sum
	end
	-- Centres and slopes of all planks at rest; the tension by bisection.
	local function rest(carried)
		local low, high, at, slope = 1, 1e6, {}, {}
		for _ = 1, 200 do
			local tension = .5 * (low + high)
			if width(carried, tension) < span then low = tension else high = tension end
		end
		local tension = .5 * (low + high)
		for i = 0, planks - 1 do
			local k, side, x, z = math.abs(i - middle), i < middle and -1 or 1, 0, 0
			for n = middle, k + 1, -1 do z = z - plank * math.sin(angle_of(carried, tension, n)) end
			for n = 0, k - 1 do x = x + (n > 0 and 1 or .5) * plank * math.cos(angle_of(carried, tension, n)) end
			local angle = angle_of(carried, tension, k)
			slope[i] = -side * angle
			at[i] = vector(side * (k > 0 and x + .5 * plank * math.cos(angle) or 0), 0, z - .5 * plank * math.sin(angle))
		end
		return at, slope
	end
	local name, at, slope = {}, rest(0)
	for i = 0, planks - 1 do
		name[i] = box { size = { .96 * plank, .6, 2 * half }, mass = mass, at = at[i],
			q = rotation(math.cos(slope[i] / 2), 0, math.sin(slope[i] / 2), 0) }
		local along = .5 * plank * vector(math.cos(slope[i]), 0, -math.sin(slope[i]))
		hinge { name[i], name[i - 1], at = at[i] - along, q = along_y, damping = 20 }
	end
	hinge { name[planks - 1], at = { .5 * span, 0, 0 }, q = along_y, damping = 20 }
	box { size = { .3, .3, .3 }, mass = load, at = { 0, 0, at[middle].z + half + .15 } }
	local hangs
	expect { "error of position", below = 1e-4, unit = "m", source = "moments of each plank about its centre", function(run)
		local off = 0
		hangs = hangs or rest(load)
		for i = 0, planks - 1 do off = math.max(off, (run[name[i]].at - hangs[i]):norm()) end
		return off
	end }
	holds(lab.moved)
elseif this.name == "ragdoll" then
	local height, lean = ({ .8, .8, 2.2 })[this.run + 1], ({ .8, 1.2, 2.8 })[this.run + 1]
	local turn = rotation(math.cos(.5 * lean), .6 * math.sin(.5 * lean), .8 * math.sin(.5 * lean), 0)
	local function put(p) return turn * p + vector(0, 0, height) end
	local function limb(from, to, radius)
		local length = (to - from):norm()
		local n = (1 / length) * (to - from)
		return capsule { radius = radius, length = length, density = 1000, at = put(.5 * (from + to)), friction = .8,
			q = turn * rotation(1 + n.z, -n.y, n.x, 0) }
	end
	local function stiff(low, high, friction) return { low = low, high = high, friction = friction, damping = .1 } end
	local function joined(a, b, at, low, high, friction, second)
		universal { a, b, at = put(at), axis = turn:axis "x", across = turn:axis "y", low = low, high = high, friction = friction,
			damping = .1, second = second }
	end
	local trunk = limb(vector(0, 0, 1), vector(0, 0, 1.4), .13)
	local head = sphere { radius = .11, mass = 5, at = put(vector(0, 0, 1.68)), q = turn, friction = .8 }
	joined(head, trunk, vector(0, 0, 1.55), -.5, .5, .3, stiff(-.6, .6, .3))
	for side = -1, 1, 2 do -- shoulder, elbow, hip and knee
		local function at(x, y, z) return vector(x, y * side, z) end
		local upper, lower = limb(at(0, .24, 1.375), at(.045, .41, 1.31), .05), limb(at(.06, .53, 1.275), at(.2, .66, 1.2), .045)
		local thigh, shank = limb(at(0, .11, .8), at(.04, .12, .58), .075), limb(at(.045, .12, .43), at(0, .13, .1), .06)
		local function bends(a, b, place, q)
			hinge { a, b, at = put(place), q = turn * q, low = -.1, high = 2, friction = .4, damping = .1 }
		end
		joined(upper, trunk, at(0, .17, 1.4), -1.2, 1.2, .4, stiff(-1.3, 1.3, .4))
		bends(lower, upper, at(.05, .475, 1.29), rotation(1, 0, 0, 0))
		joined(thigh, trunk, at(0, .1, .93), -1.2, 1.2, .4, stiff(-1.3, 1.3, .4))
		bends(shank, thigh, at(.05, .12, .5), along_y)
	end
	ground { friction = .5 }
	expect { "speed at the end", below = 1e-9, unit = "m/s", source = "they lie at rest, and sleep", function(run)
		local fastest = 0
		for _, b in ipairs(run.bodies) do fastest = math.max(fastest, b.velocity:norm()) end
		return fastest
	end }
	holds(lab.moved)
else
	local random, wheel, rate = lab.splitmix(3), .25, 6
	material "rough" { friction = .8 }
	local body = box { material = "rough", size = { 1.6, .6, .24 }, mass = 60, at = { 0, 0, wheel + .1 } }
	for k = 0, 3 do
		local at = vector(k % 2 > 0 and .6 or -.6, k > 1 and .4 or -.4, wheel)
		local turned = cylinder { material = "rough", radius = wheel, length = .14, mass = 6, at = at, q = along_y }
		hinge { turned, body, at = at, q = along_y, motor = { rate = rate, most = 40 } }
	end
	ground { material = "rough" }
	for i = 0, 9 do
		local half = random.within(.01, .03)
		box { material = "rough", static = true, size = { .1, 4, 2 * half }, at = { 1.6 + .5 * i, 0, half } }
	end
	expect { "way aside", below = .01, unit = "m", worst = true,
		source = "none, by symmetry; contacts are solved one after the other",
		function(run) return math.abs(run[body].at.y) end }
	holds(function(run)
		if run[body].moved.x <= 5 then run:fail("did not get over the bars") end
	end)
end
