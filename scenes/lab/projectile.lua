-- A box in free flight, without contacts.
case {
	row = 1,
	setup = "A box of .6 x .4 x .2 m is thrown at (10, 0, 10) m/s, tumbling at (1, 2, 3) rad/s, and watched for 2 s.",
	others = "MuJoCo with Runge-Kutta 4: 1e-10 m; Box3D 41 mm; Jolt, Bullet and ODE 163 mm",
}
scene { title = "Projectile", duration = 2 }
local start, velocity, gravity = vector(0, 0, 5), vector(10, 0, 10), vector(0, 0, -9.81)
local thrown = box { size = { .6, .4, .2 }, mass = 48, at = start, velocity = velocity, spin = { 1, 2, 3 } }

expect { "worst error of position", below = 1e-12, unit = "m", source = "parabola (Galilei 1638)", worst = true, function(run)
	local exact = start + run.time * velocity + .5 * run.time * run.time * gravity
	return (run[thrown].at - exact):norm()
end }
