-- Cylinders and capsules: standing, lying, stacked, rolling down a slope.
local this = case { row = 37, variants = {
	{
		name = "round-rest", title = "Cylinders and capsules at rest", duration = 20, what = "rest",
		setup = "Cylinders of three proportions stand, a cylinder and a capsule lie on their sides, on a plane and on boxes; friction "
			.. ".5; 20 s, awake.",
	}, {
		name = "cylinder-stack", title = "Stack of 10 cylinders", duration = 20, runs = 3, what = "stack",
		setup = "Ten cylinders of 1 m and 785 kg, each up to 10 mm off the axis, friction .5, stand for 20 s, awake; the worst of "
			.. "three such.",
	}, {
		name = "round-incline", title = "Cylinders and capsules roll down", duration = 1.5, what = "incline",
		setup = "Cylinders and capsules of .2 m radius roll down a slope of 20 degrees, a plane and a box, friction .5; 1.5 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local onto_side = vector(math.pi / 2, 0, 0) -- turns the axis from z to y
local build = {}

function build.rest()
	local kinds = {
		{ cylinder, .5, .5 }, { cylinder, .1, .5 }, { cylinder, .5, .05 }, { cylinder, .2, .5, lies = true },
		{ capsule, .2, .4, lies = true },
	}
	ground {}
	for i = 0, 9 do
		local k, on_box = i // 2, i % 2
		local kind = kinds[k + 1]
		if on_box == 1 then box { size = { 2, 2, .5 }, at = { 3 * k, 3, .25 }, static = true } end
		kind[1] { radius = kind[2], length = 2 * kind[3], mass = 100, q = kind.lies and rotation(onto_side) or nil,
			at = { 3 * k, 3 * on_box, .5 * on_box + (kind.lies and kind[2] or kind[3]) } }
	end
	lab.stands { worst = .1, drift = .1 }
end

function build.stack()
	local random = lab.splitmix(37 + this.run)
	ground {}
	for i = 0, 9 do
		local x, y = random.within(-.01, .01), random.within(-.01, .01)
		cylinder { radius = .5, length = 1, mass = 785, at = { x, y, .5 + i } }
	end
	lab.stands { worst = .5, drift = 1 }
end

function build.incline()
	local slope, radius, g, roller = 20 * math.pi / 180, .2, 9.81, {}
	local tilt = rotation(vector(0, slope, 0))
	local lying = rotation(onto_side):turn(vector(0, slope, 0))
	local down, across, up = tilt:axis "x", tilt:axis "y", tilt:axis "z"
	plane { q = tilt, friction = .5 }
	for i = 0, 3 do
		local on = 3 * i * across
		if i == 2 then
			box { size = { 10, 6, 1 }, at = 7.5 * across + 4 * down + .5 * up, q = tilt, friction = .5, static = true }
		end
		if i >= 2 then on = on + 1 * up end
		roller[i + 1] = (i % 2 == 1 and capsule or cylinder) { radius = radius, length = .8, mass = 20, at = on + radius * up,
			q = lying, friction = .5 }
	end
	for i, name in ipairs { "cylinder on a plane", "capsule on a plane", "cylinder on a box", "capsule on a box" } do
		expect { "error of the way, " .. name, below = 1e-3, source = "g sin t^2 / (2 (1 + moment)) (Routh 1905)", function(run)
			local b = run[roller[i]]
			local a = g * math.sin(slope) / (1 + b.inertia.z / (b.mass * radius * radius))
			local exact = .5 * a * run.time * run.time * down
			lab.moved(run, .1)
			return (b.moved - exact):norm() / exact:norm()
		end }
	end
end

build[this.what]()
