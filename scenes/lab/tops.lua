-- Bodies that turn about a point: a spherical pendulum, and a heavy top.
local this = case { variants = {
	{
		name = "spherical-pendulum", row = 46, title = "Spherical pendulum", duration = 20,
		setup = "A ball 1 m from a ball joint, 60 degrees from straight down, goes round at 2 rad/s; 20 s.",
	}, {
		name = "top", row = 47, title = "Heavy top", duration = 10, compared = true,
		setup = "A disk on a rod of .2 m that leans by 30 degrees spins at 100 rad/s, let go at rest otherwise: it precesses, and nods; "
			.. "10 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local g, angle, length, across, about, pull, vertical, axial, body = 9.81, nil, nil, nil, nil, nil, nil, nil, nil
-- across, about: moments about the point and the axis; pull: moment of the weight at 90 degrees; vertical, axial: angular momenta

if this.name == "top" then
	local radius, half, spin = .1, .01, 100
	angle, length = math.pi / 6, .2 -- rad from straight up
	local n = vector(math.sin(angle), 0, math.cos(angle))
	body = cylinder { radius = radius, length = 2 * half, mass = 1, at = length * n, spin = spin * n,
		q = rotation(math.cos(angle / 2), 0, math.sin(angle / 2), 0) }
	about = 1 * .5 * (radius * radius)
	across = 1 * (.25 * (radius * radius) + 1 / 12 * (2 * half) * (2 * half)) + length * length
	axial = about * spin
	vertical, pull = axial * math.cos(angle), g * length
else
	local mass, radius, rate = 1, .1, 2
	angle, length = 2 * math.pi / 3, 1
	local n, up = vector(math.sin(angle), 0, math.cos(angle)), vector(0, 0, rate)
	local spin = up + -up:dot(n) * n
	body = sphere { radius = radius, mass = mass, at = n, spin = spin, velocity = spin:cross(n) }
	about = .4 * mass * radius * radius
	across = mass + about
	vertical, axial, pull = across * math.sin(angle) * math.sin(angle) * rate, 0, mass * g
end
ball { body, at = { 0, 0, 0 } }

-- Angle of the axis from straight up, its rate, and the angle about the vertical: both angular momenta are constant (Lagrange 1788).
local follow = lab.follow(function(y)
	local s, c = math.sin(y[1]), math.cos(y[1])
	local precession = (vertical - axial * c) / (across * s * s)
	return { y[2], (across * precession * precession * s * c - axial * precession * s + pull * s) / across, precession }
end, { angle, 0, 0 })
lab.held(1e-5, "Lagrange's equations, Dormand and Prince's method to 1e-13", function(run)
	local y = follow(run.time)
	local at = vector(length * math.sin(y[1]) * math.cos(y[3]), length * math.sin(y[1]) * math.sin(y[3]), length * math.cos(y[1]))
	return (run[body].at - at):norm()
end)
