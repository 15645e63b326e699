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

-- A function of ascending times: the place of a block that begins at rest. Phases of sliding are parabolas, of sticking the table's
-- motion (Coulomb 1785).
local function follow(mu)
	local fine, fastest, limit = 2 * math.pi / frequency / 4096, amplitude * frequency, mu * g
	local of_table = fastest * frequency
	local x, v, now, pull = 0, 0, 0, nil -- at the start of a phase; pull: acceleration of sliding, nil: it sticks
	local left, begin, sample -- the phase ends where this function crosses 0; its first value, and the next time to look at it
	local function slide()
		local ahead = fastest * math.cos(frequency * (now + fine)) - v -- the table's; it drags the block along
		local a, from, began = ahead > 0 and limit or -limit, v, now
		pull, left = a, function(s) return from + a * (s - began) - fastest * math.cos(frequency * s) end
	end
	local function stick()
		pull, left = nil, function(s) return limit - math.abs(of_table * math.sin(frequency * s)) end
		if left(now + 1e-6 * fine) < 0 then
			v = fastest * math.cos(frequency * now)
			slide()
		end
	end
	local function start(phase)
		phase()
		begin, sample = left(now + .5 * fine), now + fine
	end
	-- End of the phase before a time, nil: there is none. Samples, then bisects.
	local function ending(time)
		while sample - fine < time do
			local low, high = sample - fine, math.min(sample, time)
			if left(high) * begin <= 0 then
				for _ = 1, 60 do
					local middle = .5 * (low + high)
					if left(middle) * begin > 0 then low = middle else high = middle end
				end
				return high
			end
			if sample > time then return nil end
			sample = sample + fine
		end
	end
	local function place(time)
		local s = time - now
		return pull and x + v * s + .5 * pull * s * s or x + amplitude * (math.sin(frequency * time) - math.sin(frequency * now))
	end
	start(slide)
	return function(time)
		local stop = ending(time)
		while stop do
			x, v = place(stop), pull and v + pull * (stop - now) or fastest * math.cos(frequency * stop)
			local slid = pull
			now = stop
			start(slid and math.abs(of_table * math.sin(frequency * now)) <= limit and stick or slide)
			stop = ending(time)
		end
		return place(time)
	end
end

local off, way, exact = {}, {}, {}
for i, mu in ipairs(grip) do off[i], way[i], exact[i] = 0, 0, follow(mu) end
watch(function(run)
	for i, name in ipairs(block) do
		local at = exact[i](run.time)
		off[i] = math.max(off[i], (run[name].moved - vector(at, 0, 0)):norm())
		way[i] = math.max(way[i], math.abs(at))
	end
end)
expect { "error of the displacement", below = .01, source = "each phase in closed form (Coulomb 1785)", function()
	local worst = 0
	for i = 1, #grip do worst = math.max(worst, off[i] / way[i]) end
	return worst
end }
