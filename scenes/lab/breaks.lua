-- The break: a ball hits fifteen touching balls in a triangle, along its line of symmetry. The result is symmetric.
local this = case { row = 29, runs = 4, slow = true, variants = {
	{
		name = "break-smooth", title = "Break of fifteen smooth balls", mu = 0,
		setup = "A ball at 8 m/s hits the tip of fifteen that touch in a triangle, in free space; restitution 1, .9, .5 and 0; no "
			.. "friction.",
	}, {
		name = "break-rough", title = "Break of fifteen rough balls", mu = .2,
		setup = "As before, with friction .2.",
	},
} }
scene { title = this.title, duration = 1, gravity = { 0, 0, 0 } }
local rows, radius, mass, speed = 5, .028, .17, 8
material "all" { friction = this.mu, restitution = ({ 1, .9, .5, 0 })[this.run + 1] }
local cue = sphere { radius = radius, mass = mass, at = { -.5, 0, 0 }, velocity = { speed, 0, 0 }, material = "all" }
local ball = {}
for i = 0, rows - 1 do
	ball[i] = {}
	for j = 0, i do
		ball[i][j] = sphere { radius = radius, mass = mass, at = { i * math.sqrt(3) * radius, (2 * j - i) * radius, 0 },
			material = "all" }
	end
end

-- Largest deviation, over velocities and surface speeds, of two balls from mirror images in the plane y = 0.
local function asymmetry(run, a, b)
	local p, q = run[a], run[b]
	local u, v, w, x = p.velocity, q.velocity, p.spin, q.spin
	return math.max(vector(u.x - v.x, u.y + v.y, u.z - v.z):norm(), radius * vector(w.x + x.x, w.y - x.y, w.z + x.z):norm())
end

local p, energy = mass * speed, .5 * mass * speed * speed
expect { "asymmetry", below = 1e-9, unit = "m/s", source = "none: the break is its own image", worst = true, function(run)
	local worst = asymmetry(run, cue, cue)
	for i = 0, rows - 1 do
		for j = 0, i do worst = math.max(worst, asymmetry(run, ball[i][j], ball[i][i - j])) end
	end
	return worst
end }
expect { "error of momentum", below = 1e-12, source = "momentum at the start", worst = true,
	function(run) return (run.momentum - vector(p, 0, 0)):norm() / p end }
expect { "error of angular momentum", below = 1e-9, source = "none, over the momentum times a radius", worst = true,
	function(run) return run.angular_momentum:norm() / (p * radius) end }
local gain = lab.worst(function(run) return run.energy / energy - 1 end)
expect { "gain of energy", below = 1e-9, source = "energy at the start", function(run)
	if run[ball[rows - 1][0]].velocity.x <= 0 then run:fail("the last row stands") end
	return gain()
end }
