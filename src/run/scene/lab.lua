-- The library `lab` of scenes: random numbers, and expectations that several cases have. Read when a scene first uses it.
local lab = {}

-- Random numbers of a seed by SplitMix64 (Steele, Lea and Flood 2014).
function lab.splitmix(seed)
	local state, random = seed, {}
	function random.whole()
		state = state + 0x9e3779b97f4a7c15
		local z = state
		z = (z ~ (z >> 30)) * 0xbf58476d1ce4e5b9
		z = (z ~ (z >> 27)) * 0x94d049bb133111eb
		return z ~ (z >> 31)
	end
	function random.real()
		return (random.whole() >> 11) * 0x1p-53
	end
	function random.within(low, high)
		return low + (high - low) * random.real()
	end
	-- Each component within +-size.
	function random.vector(size)
		local x, y = random.within(-size, size), random.within(-size, size)
		return vector(x, y, random.within(-size, size))
	end
	function random.rotation()
		local w = random.within(-1, 1)
		local v = random.vector(1)
		return rotation(w, v.x, v.y, v.z)
	end
	return random
end

-- Dormand and Prince's tableau (1980): the last stage is the solution of order 5; `differs` is its difference from that of order 4.
local tableau = {
	{}, { 1 / 5 }, { 3 / 40, 9 / 40 }, { 44 / 45, -56 / 15, 32 / 9 },
	{ 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729 },
	{ 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656 },
	{ 35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84 },
}
local differs = { 71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40 }

-- Integrates y' = rate(y), a list of numbers, from 0 to the time `until_time`, with an error of a step below the tolerance, or until
-- ends(y). Returns y there.
function lab.integrate(rate, y, until_time, tolerance, ends)
	local t, h, n = 0, 1e-3 * until_time, #y
	while t < until_time and not (ends and ends(y)) do
		local last, rates, following = t + h >= until_time, {}, nil
		local length = last and until_time - t or h
		for stage = 1, 7 do
			following = table.pack(table.unpack(y))
			for of = 1, stage - 1 do
				for i = 1, n do following[i] = following[i] + length * tableau[stage][of] * rates[of][i] end
			end
			rates[stage] = rate(following)
		end
		local worst = 0
		for i = 1, n do
			local error = 0
			for stage = 1, 7 do error = error + length * differs[stage] * rates[stage][i] end
			worst = math.max(worst, math.abs(error) / tolerance)
		end
		if worst <= 1 then
			y, t = following, last and until_time or t + length
		end
		h = length * math.min(5, math.max(.2, .9 * math.max(worst, 1e-10) ^ -.2))
		if h < 1e-12 * until_time then break end
	end
	return y
end

-- A function that follows y' = rate(y) from a start, to ascending times: it returns y there, to 1e-13 a step.
function lab.follow(rate, start)
	local y, now = start, 0
	return function(time)
		if time > now then y = lab.integrate(rate, y, time - now, 1e-13) end
		now = time
		return y
	end
end

-- Gauss's rule of eight points from -1 to 1.
local node = { -.96028985649753623168, -.79666647741362673959, -.52553240991632898582, -.18343464249564980494,
	.18343464249564980494, .52553240991632898582, .79666647741362673959, .96028985649753623168 }
local weight = { .10122853629037625915, .22238103445337447054, .31370664587788728734, .36268378337836198297,
	.36268378337836198297, .31370664587788728734, .22238103445337447054, .10122853629037625915 }

lab.gauss = { node = node, weight = weight }

-- Integral of f from a to b by n pieces of that rule.
function lab.quadrature(f, a, b, n)
	local sum, half = 0, .5 * (b - a) / n
	for part = 0, n - 1 do
		for i = 1, 8 do sum = sum + weight[i] * f(a + half * (2 * part + 1 + node[i])) end
	end
	return half * sum
end

-- Largest distance of a body from its start, m.
function lab.farthest(run)
	local most = 0
	for _, b in ipairs(run.bodies) do most = math.max(most, b.moved:norm()) end
	return most
end

-- Fails the run, and returns true, if a centre is a metre below the ground: through it, not just deep in it.
function lab.fell(run)
	local lowest = run["ground"].start.at.z - 1
	for _, b in ipairs(run.bodies) do
		if b.at.z < lowest then
			run:fail("fell through the ground")
			return true
		end
	end
	return false
end

-- Fails the run if no body is farther than this from its start.
function lab.moved(run, distance)
	local moved = lab.farthest(run) > (distance or 0)
	if not moved then run:fail("nothing moved") end
	return moved
end

-- A function that returns the worst of f over all looks so far.
function lab.worst(f)
	local worst = 0
	watch(function(run) worst = math.max(worst, f(run)) end)
	return function() return worst end
end

-- Expects joints to hold, bodies to move, and an error, of position unless it is named, to stay below a limit.
function lab.held(limit, source, error_of, name, unit)
	local gap = lab.worst(function(run) return run.gap end)
	expect { name or "error of position", below = limit, unit = unit or "m", source = source, worst = true, error_of }
	expect { "gap of a joint", below = 1e-9, unit = "m", source = "its two places are one", function(run)
		lab.moved(run)
		return gap()
	end }
end

-- Expects a structure to stand: limits of the worst penetration and of the drift aside, mm. every: steps between looks;
-- carried(time): displacement of its support; creep: name and meaning of the drift.
function lab.stands(limit)
	local depth, drift, fallen, sum, looks, step = 0, 0, 0, 0, 0, -1
	watch(function(run)
		step = step + 1
		if step % (limit.every or 1) ~= 0 then return end
		local worst, mean = run:penetration()
		local carried = limit.carried and limit.carried(run.time) or vector(0, 0, 0)
		depth, sum, looks, fallen = math.max(depth, 1e3 * worst), sum + mean, looks + 1, 0
		for _, b in ipairs(run.bodies) do
			local moved = b.moved - carried
			drift = math.max(drift, 1e3 * moved:aside())
			if moved:norm() > .25 then fallen = fallen + 1 end
		end
		if fallen > 0 then run:fail("fell") end
	end)
	expect { "worst penetration", unit = "mm", below = limit.worst, source = "no penetration", function() return depth end }
	expect { limit.creep or "drift", unit = "mm", below = limit.drift,
		source = limit.meaning or "it stays: farthest that a body gets aside", function() return drift end }
	expect { "bodies that fell", below = 0, source = limit.holds or "none: the stack is stable", function() return fallen end }
	expect { "mean penetration", unit = "mm", source = "no penetration; over contacts and time",
		function() return 1e3 * sum / looks end }
end

-- Expects bodies to fall and come to rest by `duration`: limits of the mean and the worst penetration in the last second, of
-- the worst ever, mm, and of the growth of energy over that at the start; nil: shown alone; growth = false: not shown.
-- ground = false: there is none to fall through.
function lab.heap(limit, duration)
	local sum, looks, settled, depth, growth, start, lowest = 0, 0, 0, 0, 0, nil, nil
	local names = limit.names or { "settled mean penetration", "settled worst penetration" }
	local last = limit.names and "" or "; in the last second"
	watch(function(run)
		local worst, mean = run:penetration()
		local energy = run.energy
		depth = math.max(depth, 1e3 * worst)
		if run.time > duration - 1 then
			sum, looks, settled = sum + mean, looks + 1, math.max(settled, 1e3 * worst)
		end
		start = start or energy
		lowest = math.min(lowest or energy, energy)
		growth = math.max(growth, (energy - lowest) / start)
		if limit.ground ~= false then lab.fell(run) end
	end)
	expect { names[1], unit = "mm", below = limit.mean, source = "no penetration" .. last, function(run)
		lab.moved(run, .1)
		return 1e3 * sum / math.max(looks, 1)
	end }
	expect { names[2], unit = "mm", below = limit.settled, source = "no penetration" .. last, function() return settled end }
	expect { "worst penetration at any moment", unit = "mm", below = limit.worst, source = "no penetration",
		function() return depth end }
	if limit.growth ~= false then
		expect { "growth of energy", below = limit.growth,
			source = "none: largest rise from its lowest so far, over that at the start", function() return growth end }
	end
end

return lab
