-- Heaps of frictionless spheres: SimBenchmark's 666 tests.
local this = case { variants = {
	{
		name = "666", row = 7, title = "SimBenchmark's 666 test", lift = .101, e = 0, compared = true,
		setup = "6 x 6 x 6 spheres of radius .1 m and 10 kg in a grid of .21 m, displaced by up to 1 mm, collapse on the "
			.. "ground without friction or restitution; 10 s.",
		others = "at 60 Hz 7e-4 m^2 (Jolt, Bullet)",
	}, {
		name = "elastic-666", row = 8, title = "SimBenchmark's elastic 666 test", lift = 1.101, e = 1,
		setup = "The spheres of the 666 test, 1 m higher and with restitution 1; 10 s.",
		others = "60 Hz 4 to 47 %; ODE at 1 kHz .03 %; RaiSim 8.4 J^2 at 1 ms",
	},
} }
scene { title = this.title, duration = 10 }
local radius, random, ball = .1, lab.splitmix(666), {}
material "all" { friction = 0, restitution = this.e }
ground { material = "all" }
for n = 0, 215 do
	local x, y, z = random.real(), random.real(), random.real()
	local p = .21 * vector(n // 36, n // 6 % 6, n % 6) + .001 * vector(x, y, z)
	ball[n + 1] = sphere { radius = radius, mass = 10, at = p + vector(0, 0, this.lift), material = "all" }
end

-- m^2, over all pairs, and with the ground.
local function squared_penetration(run)
	local at, sum, reach = {}, 0, 2 * radius
	for i, name in ipairs(ball) do
		local p = run[name].at
		at[i] = { p.x, p.y, p.z }
	end
	for i = 1, #at do
		local p = at[i]
		local x, y, z = p[1], p[2], p[3]
		if z < radius then sum = sum + (radius - z) ^ 2 end
		for j = i + 1, #at do
			local q = at[j]
			local dx = x - q[1]
			if dx < reach and dx > -reach then
				local dy, dz = y - q[2], z - q[3]
				local distance = (dx * dx + dy * dy + dz * dz) ^ .5
				if distance < reach then sum = sum + (reach - distance) ^ 2 end
			end
		end
	end
	return sum
end

local frames, mean, start = -1, 0, nil
local function average(value)
	frames = frames + 1
	if frames > 0 then mean = mean + (value - mean) / frames end
end

if this.name == "666" then
	watch(function(run)
		average(squared_penetration(run))
		lab.fell(run)
	end)
	expect { "mean sum of squared penetrations", below = 1e-5, unit = "m^2", source = "no penetration (Kang and Hwangbo 2018)",
		function(run)
			lab.moved(run, .05)
			return mean
		end }
	expect { "worst penetration", unit = "mm", source = "no penetration", worst = true,
		function(run) return 1e3 * run:penetration() end }
else
	watch(function(run)
		start = start or run.energy
		average((run.energy - start) ^ 2)
		lab.fell(run)
	end)
	expect { "rms error of energy", below = 1e-3, source = "energy at the start", function(run)
		lab.moved(run, .05)
		return math.sqrt(mean) / start
	end }
	expect { "mean squared error of energy", unit = "J^2", source = "energy at the start (Kang and Hwangbo 2018)",
		function() return mean end }
end
