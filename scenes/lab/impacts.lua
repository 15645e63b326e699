-- Head-on impact of two bodies: twelve runs, over shape, ratio of masses and restitution; at the origin, far from it, and with
-- a partner that reads late.
local this = case { runs = 12, variants = {
	{
		name = "head-on", row = 2, title = "Head-on pair",
		setup = "A sphere meets a sphere, and a box a box, head-on at 1 m/s in free space: masses 1:1 and 1:1000, "
			.. "restitution 0, .5 and 1.",
		others = "relative errors of 4e-7 at best",
	}, {
		name = "far-head-on", row = 23, title = "Head-on pair at 10 km",
		setup = "The head-on pairs at the origin and the same 10 km away.",
	}, {
		name = "lag", row = 24, title = "Partners that read late",
		setup = "The head-on pairs, each body a simulator that computes the impulse for itself, on a state of its "
			.. "partner that is so many iterations late. The target holds without lag.",
		others = "no other engine couples simulators",
	},
} }
scene { title = this.title, duration = 2, gravity = { 0, 0, 0 } }
local ratio, e, boxes = this.run // 3 % 2 == 1 and 1000 or 1, ({ 0, .5, 1 })[this.run % 3 + 1], this.run >= 6

-- Both are 1 m wide, and touch within a frame, not at its end.
local function pair(x)
	local body = {}
	for i = 0, 1 do
		local b = { at = { x + 1.537 * i, 0, 0 }, mass = i == 1 and ratio or 1, velocity = { 1 - i, 0, 0 },
			friction = .3, restitution = e }
		if boxes then b.size = { 1, 1, 1 } else b.radius = .5 end
		body[i + 1] = (boxes and box or sphere)(b)
	end
	return body
end

local change = (1 + e) * (0 - 1)
local exact = { vector(1 + ratio / (1 + ratio) * change, 0, 0), vector(0 - 1 / (1 + ratio) * change, 0, 0) }

local function error_of(run, p)
	local a, b = run[p[1]], run[p[2]]
	if a.velocity.x > .999 or a.at.x > b.at.x then run:fail("passed through") end
	return math.max((a.velocity - exact[1]):norm(), (b.velocity - exact[2]):norm())
end

local newton, start = "impact of two bodies (Newton 1687)", "energy at the start"
local function momentum(run) return (run.momentum - vector(1, 0, 0)):norm() end
local function gain(run) return (run.energy - .5) / .5 end

local near = pair(0)
if this.name == "far-head-on" then
	local far = pair(10e3)
	expect { "error of velocities at 10 km", below = 1e-6, source = newton, function(run)
		error_of(run, near)
		return error_of(run, far)
	end }
	expect { "difference of ways", unit = "m", below = 1e-6, source = "the pair at the origin", function(run)
		local function apart(i) return (run[far[i]].moved - run[near[i]].moved):norm() end
		return math.max(apart(1), apart(2))
	end }
elseif this.name == "lag" then
	expect { "error of momentum", below = 1e-15, source = "momentum at the start", worst = true, momentum }
	expect { "error of velocities", source = newton, function(run) return error_of(run, near) end }
	expect { "gain of energy", source = start, worst = true, gain }
else
	expect { "error of velocities, e > 0", below = 1e-12, source = newton, function(run)
		local error = error_of(run, near)
		return e > 0 and error or 0
	end }
	expect { "error of velocities, e = 0", below = 1e-8, source = newton,
		function(run) return e > 0 and 0 or error_of(run, near) end }
	expect { "error of momentum", below = 1e-15, source = "momentum at the start", worst = true, momentum }
	expect { "gain of energy", below = 1e-15, source = start .. "; the target is rounding", worst = true, gain }
end
