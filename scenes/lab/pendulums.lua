-- Pendulums: a ball of 1 kg and .1 m, 1 m below a hinge; and two such, the lower hanging at the upper one's centre.
local swings = "the pendulum's equation (Huygens 1673), Dormand and Prince's method to 1e-13"
local this = case { variants = {
	{
		name = "pendulum-90", row = 44, title = "Pendulum of 90 degrees", duration = 20, angle = 90, target = 1e-5, source = swings,
		compared = true,
		setup = "A ball 1 m below a hinge is let go level; 20 s.",
	}, {
		name = "pendulum-179", row = 44, title = "Pendulum of 179 degrees", duration = 20, angle = 179, target = 1e-3, source = swings,
		setup = "The same, let go 1 degree from straight up; 20 s.",
	}, {
		name = "double-pendulum", row = 45, title = "Double pendulum", duration = 4, target = 1e-4, compared = true,
		source = "Lagrange's equations, Dormand and Prince's method to 1e-13",
		setup = "Two balls on two arms of 1 m are let go level; 4 s, before its chaos hides all errors.",
	},
} }
scene { title = this.title, duration = this.duration }
local g, mass, radius = 9.81, 1, .1
local moment, across = .4 * mass * radius * radius, rotation(math.sqrt(.5), -math.sqrt(.5), 0, 0) -- a hinge's z along y
local top = vector(0, 0, 0)
local function hanging(from, angle) return from + 1 * vector(math.sin(angle), 0, -math.cos(angle)) end

if this.angle then
	local start = this.angle * math.pi / 180
	local bob = sphere { radius = radius, mass = mass, at = hanging(top, start) }
	hinge { bob, at = top, q = across }
	local follow = lab.follow(function(y) return { y[2], -mass * g / (mass + moment) * math.sin(y[1]) } end, { start, 0 })
	lab.held(this.target, this.source, function(run) return (run[bob].at - hanging(top, follow(run.time)[1])):norm() end)
else
	local upper = sphere { radius = radius, mass = mass, at = { 1, 0, 0 } }
	local lower = sphere { radius = radius, mass = mass, at = { 2, 0, 0 } }
	hinge { upper, at = top, q = across }
	hinge { lower, upper, at = { 1, 0, 0 }, q = across }
	local follow = lab.follow(function(y)
		local m, i, k = mass, 2 * mass + moment, mass + moment
		local c, s = m * math.cos(y[1] - y[2]), m * math.sin(y[1] - y[2])
		local det = i * k - c * c
		local f, h = -s * y[4] * y[4] - 2 * m * g * math.sin(y[1]), s * y[3] * y[3] - m * g * math.sin(y[2])
		return { y[3], y[4], (k * f - c * h) / det, (i * h - c * f) / det }
	end, { math.pi / 2, math.pi / 2, 0, 0 })
	lab.held(this.target, this.source, function(run)
		local y = follow(run.time)
		return (run[lower].at - hanging(hanging(top, y[1]), y[2])):norm()
	end)
end
