-- Rocking blocks and cylinders: on one edge or point of the rim until upright, then on the opposite one.
local this = case { row = 31, slow = true, variants = {
	{
		name = "rocking-blocks", title = "Rocking blocks", duration = 2.5, slenderness = { 2, 4, 10 }, hits = 3, hit = "a hit",
		before = "the first hit",
		setup = "Blocks of 1 m, 2, 4 and 10 times as high as wide, start at rest on an edge, tilted by half of the angle at which they "
			.. "would topple, and hit three times; friction 2, no restitution.",
	}, {
		name = "rocking-cylinders", title = "Rocking cylinders", duration = .6, slenderness = { 2, 4 }, hits = 1, hit = "the hit",
		before = "the hit",
		setup = "Cylinders of 1 m, 2 and 4 times as high as wide, start at rest on their rim as the blocks, and hit once.",
	},
} }
scene { title = this.title, duration = this.duration }
local g, height, depth, rough = 9.81, .5, .3, 2 -- m: half height and half depth; friction: they do not slip
local blocks, body = this.name == "rocking-blocks", {}
ground { friction = rough }
for i, slender in ipairs(this.slenderness) do
	local half = height / slender
	local angle = .5 * math.atan(half, height) -- half of the toppling angle about y, on the edge or rim towards +x
	local b = { friction = rough, q = rotation(vector(0, angle, 0)),
		at = { 10 * (i - 1), 0, half * math.sin(angle) + height * math.cos(angle) } }
	if blocks then
		b.size, b.mass = { 2 * half, 2 * depth, 2 * height }, 1000 * half * depth * height
	else
		b.radius, b.length, b.mass = half, 2 * height, 1000 * half * half
	end
	body[i] = { name = (blocks and box or cylinder)(b), half = half, alpha = math.atan(half, height), angle = angle, tilt = 0, hits = 0,
		ratio = 0, loss = 0 }
end

-- Time (s) from this angle and rate to upright: angle'^2 / 2 = c (k - cos(alpha - angle)), where c = g R / (moment + R^2).
-- Substitutes angle = from (1 - s^2): the rate vanishes like s at a start from rest.
local function time_upright(r, angle, w)
	local arm = vector(r.half, height, 0):aside()
	local c = g * arm / (r.moment + arm * arm)
	local k = math.cos(r.alpha - angle) + .5 * w * w / c
	return lab.quadrature(function(s)
		return 2 * s * angle / math.sqrt(2 * c * (k - math.cos(r.alpha - angle * (1 - s * s))))
	end, 0, 1, 64)
end

-- Rate, squared, at the impact without loss of energy.
local function rate_of_hit(r, b)
	local arm = r.half * r.half + height * height
	return (b.velocity:dot(b.velocity) + r.moment * b.spin:dot(b.spin) + 2 * g * (b.at.z - height)) / (r.moment + arm)
end

watch(function(run)
	for _, r in ipairs(body) do
		local b = run[r.name]
		local up = b.turn:axis "z"
		local angle = math.atan(up.x, up.z)
		r.moment = r.moment or b.inertia.y / b.mass
		local rate, start = rate_of_hit(r, b), rate_of_hit(r, b.start)
		local hit = run.time > 0 and (angle < 0) ~= (r.tilt < 0)
		if hit and r.hits == 0 then r.quarter = math.abs(r.upright / time_upright(r, r.angle, 0) - 1) end
		if hit and r.hits < this.hits then
			local b2, h2 = r.half * r.half, height * height
			local exact = (r.moment + h2 - b2) / (r.moment + h2 + b2) -- moment of momentum about the new pivot
			r.ratio = math.max(r.ratio, math.abs(math.sqrt(rate / r.rate) / exact - 1))
		end
		r.hits = r.hits + (hit and 1 or 0)
		if r.hits == 0 then
			r.upright = run.time + time_upright(r, angle, b.spin.y)
			r.loss = math.max(r.loss, math.abs(rate / start - 1))
		end
		r.tilt, r.rate = angle, rate
	end
end)

for i, r in ipairs(body) do
	expect { "error of a quarter period, " .. this.slenderness[i] .. " : 1", below = 5e-4,
		source = "angle'' = -g R / (moment + R^2) sin(alpha - angle) (Housner 1963)", function() return r.quarter or 0 end }
end
for i, r in ipairs(body) do
	expect { "error of the ratio at " .. this.hit .. ", " .. this.slenderness[i] .. " : 1", below = 2e-3,
		source = "moment of momentum about the new pivot (Housner 1963)", function() return r.ratio end }
end
expect { "error of energy before " .. this.before, source = "none before it hits", function(run)
	local worst = 0
	for _, r in ipairs(body) do
		if r.hits < 1 then run:fail("never hit") end
		worst = math.max(worst, r.loss)
	end
	lab.fell(run)
	return worst
end }
