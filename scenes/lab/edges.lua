-- On the stable or the unstable side of a limit: bricks over a table's edge, two leaning cards, an arch.
local johnson, heyman = "sum of L / 2 k (Johnson 1955)", "a line of thrust within all joints (Heyman 1969)"
local moments = "mu >= (tan(angle) - d / l) / 2, by the balance of moments"
local this = case { variants = {
	{
		name = "overhang", row = 21, title = "Bricks at the full overhang", duration = 3, what = "bricks", share = 1,
		source = johnson, stands = true,
		setup = "Four bricks reach 25/24 of their length over a table's edge, the most that can stand; 3 s.",
	}, {
		name = "overhang-over", row = 21, title = "Bricks 1 % over the overhang", duration = 3, what = "bricks", share = 1 + .01,
		source = johnson,
		setup = "As before, every brick 1 % farther out: they must topple within 3 s.",
	}, {
		name = "a-frame-stands", row = 22, title = "Two cards that lean and stand", duration = 60, what = "cards", share = 1.02,
		source = moments, stands = true,
		setup = "Two boxes of 1 x 1 x .02 m lean on each other at 30 degrees to the vertical, with 2 % more friction on the "
			.. "ground than they need; 60 s.",
	}, {
		name = "a-frame-slides", row = 22, title = "Two cards that lean and slide", duration = 60, what = "cards", share = .98,
		source = moments,
		setup = "As before, with 2 % less friction than they need: they must slide down within 60 s.",
	}, {
		name = "arch-stands", row = 43, title = "An arch that just stands", duration = 20, what = "arch", share = 1.001,
		source = heyman, stands = true,
		setup = "Twenty voussoirs in a half circle of 5 m without mortar, .1 % thicker than they must be; friction .9; 20 s.",
	}, {
		name = "arch-falls", row = 43, title = "An arch that just falls", duration = 20, what = "arch", share = .999,
		source = heyman,
		setup = "As before, .1 % thinner than they must be: it must fall within 20 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local build = {}

-- They balance on the edge. A rounding error grows e-fold three times a second; in 3 s it stays invisible. share: of the reach.
function build.bricks()
	box { size = { 4, 1, 1 }, at = { -2, 0, -.5 }, static = true } -- the table: its edge at x = 0
	ground { height = -4 }
	local x, bricks = -.5, 4
	for i = 0, bricks - 1 do
		x = x + this.share * (.5 / (bricks - i))
		box { size = { 1, .5, .2 }, mass = 1, at = { x, 0, .1 + .2 * i } }
	end
end

-- Cards of 1 m x 1 m x 20 mm that lean at 30 degrees to the vertical; their inner upper edges touch at x = 0. share: friction on
-- the ground, relative to what they need; the cards' own contact is rough.
function build.cards()
	local angle, length, thickness, rough = math.pi / 6, 1, .02, 2
	local mu = this.share * (.5 * (math.tan(angle) - thickness / length))
	local along, inner = vector(math.sin(angle), 0, math.cos(angle)), vector(math.cos(angle), 0, -math.sin(angle)) -- of the left one
	local edge = .5 * length * along + .5 * thickness * inner
	local foot = .5 * thickness * inner - .5 * length * along
	ground { friction = mu * mu / rough } -- with a card's: mu
	for side = -1, 1, 2 do
		box { size = { thickness, 1, length }, mass = 1, at = { side * edge.x, 0, -foot.z }, friction = rough,
			q = rotation(vector(0, -side * angle, 0)) }
	end
end

-- Least thickness of a half circle of voussoirs, m. The thrust crosses the crown at a moment Q about the centre, and each joint at
-- (Q + moment) / (weight cosine + thrust sine) from it: there must be a Q for some thrust.
local function least_thickness(voussoirs, radius)
	local function stands(thickness)
		local inner, outer, joints, weight, moment = radius - .5 * thickness, radius + .5 * thickness, {}, 0, 0
		for j = 0, voussoirs // 2 - 1 do -- from the crown down, with the part above
			local from, to = math.pi * (voussoirs // 2 - j) / voussoirs, math.pi * (voussoirs // 2 - j - 1) / voussoirs
			local c, s, d, t = math.cos(to), math.sin(to), math.cos(from), math.sin(from)
			local x, z = { inner * c, outer * c, outer * d, inner * d }, { inner * s, outer * s, outer * t, inner * t }
			for k = 1, 4 do
				local n = k % 4 + 1
				local area = .5 * (x[k] * z[n] - x[n] * z[k])
				weight, moment = weight + area, moment + area * (x[k] + x[n]) / 3
			end
			joints[j + 1] = { c, s, weight, moment }
		end
		-- The largest lower bound of Q less the smallest upper one, convex in the thrust, and its slope there.
		local function excess(thrust)
			local least, greatest, up, down = inner * thrust, outer * thrust, inner, outer
			for _, j in ipairs(joints) do
				local normal = j[3] * j[1] + thrust * j[2]
				local low, high = inner * normal - j[4], outer * normal - j[4]
				if low > least then least, up = low, inner * j[2] end
				if high < greatest then greatest, down = high, outer * j[2] end
			end
			return least - greatest, up - down
		end
		local low, high, lowest = 0, 3 * weight, nil
		local left, falling = excess(low)
		local right, rising = excess(high)
		for _ = 1, 20 do -- the lines at both ends meet at or below the minimum (Kelley 1960)
			local thrust = (right - left + falling * low - rising * high) / (falling - rising)
			local slope
			lowest, slope = excess(thrust)
			if lowest <= left + falling * (thrust - low) then break end
			if slope < 0 then low, left, falling = thrust, lowest, slope else high, right, rising = thrust, lowest, slope end
		end
		return lowest <= 0
	end
	local falls, holds = 0, radius
	for _ = 1, 60 do
		local thickness = .5 * (falls + holds)
		if stands(thickness) then holds = thickness else falls = thickness end
	end
	return holds
end

function build.arch()
	local voussoirs, radius, depth = 20, 5, .5
	local half = .5 * this.share * least_thickness(voussoirs, radius)
	ground { friction = .9 }
	for i = 0, voussoirs - 1 do
		local points = {}
		for k = 0, 7 do
			local angle, r = math.pi * (i + (k & 1)) / voussoirs, radius + (k & 2 > 0 and half or -half)
			points[k + 1] = { r * math.cos(angle), k & 4 > 0 and depth or -depth, r * math.sin(angle) }
		end
		hull { points = points, mass = 1000, friction = .9 }
	end
end

build[this.what]()

local farthest, fell = 0, false
watch(function(run)
	farthest = math.max(farthest, 1e3 * lab.farthest(run))
	fell = lab.fell(run)
end)
expect { "on the wrong side", below = 0, source = this.source, function(run)
	local wrong
	if this.stands then wrong = farthest > 50 else wrong = fell or farthest <= 50 end
	if wrong and not fell then run:fail(this.stands and "fell" or "stands") end
	return wrong and 1 or 0
end }
expect { "farthest that a body moved", unit = "mm", source = this.source, function() return farthest end }
