-- Over ten seams: fixed boxes side by side, with their upper faces in one plane, act as one floor.
local this = case { row = 34, variants = {
	{
		name = "seams-slide", title = "Boxes slide over ten seams", duration = 1.2,
		setup = "Boxes of two sizes, turned by three angles, slide at 5 m/s over fixed boxes of .25 m side by side until they "
			.. "stop; friction .5.",
	}, {
		name = "seams-roll", title = "Round ones roll over ten seams", duration = .5,
		setup = "Spheres, cylinders and capsules of .1 m radius roll at 5 m/s over fixed boxes of .25 m side by side; friction "
			.. ".5; .5 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local lanes, tile, mu, speed, g = 6, .25, .5, 5, 9.81
for lane = 0, lanes - 1 do
	for i = 0, 13 do
		box { size = { tile, 1.2, .2 }, at = { tile * (i - .5), 2 * lane, -.1 }, friction = mu, static = true }
	end
end

local body = {}
if this.name == "seams-slide" then
	for lane = 0, lanes - 1 do
		local size = lane % 2 == 1 and { .4, .3, .1 } or { .2, .16, .1 }
		body[lane] = box { size = size, mass = 4, at = { .013 * lane, 2 * lane, .05 }, velocity = { speed, 0, 0 }, friction = mu,
			q = rotation(vector(0, 0, .3 * (lane // 2))) }
	end
else -- round bodies lie with their axes across the lane, and roll from the start
	local radius, lying = .1, rotation(vector(math.pi / 2, 0, 0))
	for lane = 0, lanes - 1 do
		local b = { radius = radius, mass = 4, at = { .013 * lane, 2 * lane, radius }, velocity = { speed, 0, 0 },
			spin = { 0, speed / radius, 0 }, friction = mu }
		if lane > 1 then b.length, b.q = .4, lying end
		body[lane] = ({ sphere, cylinder, capsule })[lane // 2 + 1](b)
	end
end

-- Largest of the lanes from one to another.
local function largest(run, from, to, f)
	local most = 0
	for lane = from, to do
		local moved = run[body[lane]].moved
		if moved.z < -.05 then run:fail("fell through the floor") end
		most = math.max(most, f(moved))
	end
	return most
end
local function hop(moved) return 1e3 * moved.z end
local function error_of(exact)
	return function(moved) return (moved - vector(exact, 0, 0)):aside() / exact end
end

if this.name == "seams-slide" then
	expect { "worst error of the way", below = 1e-3, source = "v^2 / (2 mu g) (Coulomb 1785)",
		function(run) return largest(run, 0, 5, error_of(speed * speed / (2 * mu * g))) end }
	expect { "highest hop", below = .01, unit = "mm", source = "none: the floor is level", worst = true,
		function(run) return largest(run, 0, 5, hop) end }
else
	for k, kind in ipairs { "spheres", "cylinders", "capsules" } do
		expect { "error of the way, " .. kind, below = 1e-3, source = "v t: it rolls on (Newton 1687)",
			function(run) return largest(run, 2 * k - 2, 2 * k - 1, error_of(speed * run.time)) end }
		expect { "highest hop, " .. kind, below = .01, unit = "mm", source = "none: the floor is level", worst = true,
			function(run) return largest(run, 2 * k - 2, 2 * k - 1, hop) end }
	end
end
