-- Bodies dropped exactly flat, on a face or on an edge below the centre, rise straight up again: the points hit at once, and their
-- order must not show.
local this = case { row = 28, variants = {
	{
		name = "drops-plane", title = "Boxes dropped flat on a plane",
		setup = "Boxes of four proportions fall 1 m on a face, or on an edge below their centre: restitution .2 to 1, friction 0 "
			.. "to 1, two bounces.",
	}, {
		name = "drops-box", title = "Boxes dropped flat on boxes", boxes = true,
		setup = "As before, on the upper faces of fixed boxes that are turned otherwise.",
	}, {
		name = "drops-round", title = "Cylinders and capsules dropped flat", round = true,
		setup = "Cylinders on a face and on their side, capsules on their side, as the boxes before, on a plane.",
	},
} }
scene { title = this.title, duration = 2.4 }
local g, height, bounces, all = 9.81, 1, 2, 96
local half = { { .25, .25, .25 }, { .4, .4, .1 }, { .1, .1, .4 }, { .1, .2, .4 } }
local restitution, friction = { .2, .5, .8, 1 }, { 0, .3, 1 }

-- kind: 0 on a face, 1 on an edge
local function drop_of(i)
	return { kind = i % 2, proportion = i // 2 % 4, e = restitution[i // 8 % 4 + 1], mu = friction[i // 32 + 1] }
end
local function place(i, z) return { 4 * (i % 10), 4 * (i // 10), z } end

-- With a ground of friction 1, the pair's is mu.
local function lift(b, i, lowest, tilt)
	local d = drop_of(i)
	b.friction, b.restitution = d.mu * d.mu, d.e
	b.at, b.q = place(i, height + lowest), rotation(tilt):turn(vector(0, 0, .37 * i))
	return b
end

local body = {}
if not this.boxes then ground { friction = 1 } end
for i = 0, all - 1 do
	local d = drop_of(i)
	if this.round then
		local kind = d.proportion % 3
		body[i] = (kind == 2 and capsule or cylinder)(lift({ radius = .2, length = .6, mass = 10 }, i, kind > 0 and .2 or .3,
			vector(0, kind > 0 and math.pi / 2 or 0, 0)))
	else
		local h, edge = half[d.proportion + 1], d.kind == 1
		body[i] = box(lift({ size = { 2 * h[1], 2 * h[2], 2 * h[3] }, mass = 1000 * h[1] * h[2] * h[3] }, i,
			edge and vector(h[1], h[3], 0):aside() or h[3], vector(0, edge and math.atan(h[1], h[3]) or 0, 0)))
	end
end
for i = 0, this.boxes and all - 1 or -1 do
	box { size = { 2, 2.4, .6 }, at = place(i, -.3), friction = 1, q = rotation(vector(0, 0, .61 * i)), static = true }
end

-- A flight's apex follows from its height and speed. kind: nil: all
local count, last = {}, {}
local function worst_of(run, kind, f)
	local worst = 0
	for i = 0, all - 1 do
		local d = drop_of(i)
		local ends = (1 + 2 * d.e + 2 * d.e * d.e) * math.sqrt(2 * height / g)
		if (not kind or d.kind == kind) and (count[i] or 0) <= bounces and run.time <= ends then
			worst = math.max(worst, f(run[body[i]], d, count[i] or 0))
		end
	end
	return worst
end
watch(function(run)
	for i = 0, all - 1 do
		local v = run[body[i]].velocity.z
		if (last[i] or 0) < 0 and v > 0 then count[i] = (count[i] or 0) + 1 end
		last[i] = v
	end
end)

for kind, on in pairs(this.round and { [2] = "face or side" } or { [0] = "face", [1] = "edge" }) do
	local of = kind < 2 and kind or nil
	local straight = "none: it goes straight up again, by symmetry"
	expect { "sideways velocity, " .. on, below = 1e-9, unit = "m/s", source = straight, worst = true,
		function(run) return worst_of(run, of, function(b) return b.velocity:aside() end) end }
	expect { "spin, " .. on, below = 1e-9, unit = "rad/s", source = straight, worst = true,
		function(run) return worst_of(run, of, function(b) return b.spin:norm() end) end }
	local error = lab.worst(function(run)
		return worst_of(run, of, function(b, d, k)
			local apex = height + b.moved.z + b.velocity.z * b.velocity.z / (2 * g)
			return k > 0 and math.abs(apex - height * d.e ^ (2 * k)) / height or 0
		end)
	end)
	expect { "error of height over the drop, " .. on, below = 1e-6, source = "h e^(2 k) (Newton 1687)", function(run)
		for i = 0, all - 1 do
			if not count[i] then run:fail("never bounced") end
		end
		return error()
	end }
end
