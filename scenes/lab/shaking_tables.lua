-- Blocks on tables that go to and fro: they slide and stop, or stick.
case {
	name = "shaking-tables", row = 39,
	setup = "Boxes of 10 kg on six tables that go to and fro by .1 m at up to .4 g; friction of .1, .2, .3 and .39 (they slide, and "
		.. "stop), .41 and .8 (they stick); the largest displacement that is missed at any moment, against the largest way; 5 s.",
}
scene { title = "Blocks on shaking tables", duration = 5 }
local g, amplitude = 9.81, .1
local frequency = math.sqrt(.4 * g / amplitude) -- rad/s
local grip, block = { .1, .2, .3, .39, .41, .8 }, {}
for i, mu in ipairs(grip) do
	box { size = { 4, 2, .2 }, at = { 0, 4 * (i - 1), -.1 }, friction = mu, kind = "kinematic",
		path = { kind = "sine", amplitude = { amplitude, 0, 0 }, rate = frequency } }
	block[i] = box { size = { .4, .4, .2 }, mass = 10, at = { 0, 4 * (i - 1), .1 }, friction = mu }
end

-- First instant after from + fine / 2 at which f crosses 0; the end: none before. Samples, then bisects.
local function crossing(f, from, until_time, fine)
	local begin, t = f(from + .5 * fine), from + fine
	while t - fine < until_time do
		local low, high = t - fine, math.min(t, until_time)
		if f(high) * begin <= 0 then
			for _ = 1, 60 do
				local middle = .5 * (low + high)
				if f(middle) * begin > 0 then low = middle else high = middle end
			end
			return high
		end
		t = t + fine
	end
	return until_time
end

-- Place of a block that begins at rest: phases of sliding are parabolas, of sticking the table's motion (Coulomb 1785).
local function place(mu, t)
	local fine, fastest, limit = 2 * math.pi / frequency / 4096, amplitude * frequency, mu * g
	local x, v, now, sticks = 0, 0, 0, false
	local of_table = fastest * frequency
	while now < t do
		if sticks then
			local function holds(s) return limit - math.abs(of_table * math.sin(frequency * s)) end
			local stop = holds(now + 1e-6 * fine) < 0 and now or crossing(holds, now, t, fine)
			x = x + amplitude * (math.sin(frequency * stop) - math.sin(frequency * now))
			v, now, sticks = fastest * math.cos(frequency * stop), stop, false
			if now >= t then break end
		end
		local ahead = fastest * math.cos(frequency * (now + fine)) - v -- the table's; it drags the block along
		local a, from, began = ahead > 0 and limit or -limit, v, now
		local stop = crossing(function(s) return from + a * (s - began) - fastest * math.cos(frequency * s) end, now, t, fine)
		local s = stop - now
		x, v, now = x + v * s + .5 * a * s * s, v + a * s, stop
		sticks = now < t and math.abs(of_table * math.sin(frequency * now)) <= limit
	end
	return x
end

local off, way = {}, {}
for i = 1, #grip do off[i], way[i] = 0, 0 end
watch(function(run)
	for i, name in ipairs(block) do
		local exact = place(grip[i], run.time)
		off[i] = math.max(off[i], (run[name].moved - vector(exact, 0, 0)):norm())
		way[i] = math.max(way[i], math.abs(exact))
	end
end)
expect { "error of the displacement", below = .01, source = "each phase in closed form (Coulomb 1785)", function()
	local worst = 0
	for i = 1, #grip do worst = math.max(worst, off[i] / way[i]) end
	return worst
end }
