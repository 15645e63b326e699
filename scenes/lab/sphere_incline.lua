-- A sphere on a slope, with friction just above and just below that of rolling.
local this = case { row = 13, variants = {
	{
		name = "sphere-incline-roll", title = "Sphere rolls down a slope", share = 1.1,
		setup = "A sphere on a slope of 20 degrees, friction 10 % above 2/7 tan(20); 2 s.",
		speed = "5/7 g sin t (Routh 1905)", way = "5/14 g sin t^2 (Routh 1905)",
	}, {
		name = "sphere-incline-slip", title = "Sphere slips down a slope", share = .9,
		setup = "A sphere on a slope of 20 degrees, friction 10 % below 2/7 tan(20); 2 s.",
		speed = "g (sin - mu cos) t (Routh 1905)", way = "g (sin - mu cos) t^2 / 2 (Routh 1905)",
	},
} }
scene { title = this.title, duration = 2 }
local g, slope = 9.81, 20 * math.pi / 180
local tilt = rotation(vector(0, slope, 0))
local grip = 2 * math.tan(slope) / 7
local mu, down = this.share * grip, tilt:axis "x"
plane { q = tilt, friction = mu }
local ball = sphere { radius = .5, mass = 10, at = .5 * tilt:axis "z", friction = mu }
local a = mu >= grip and 5 * g * math.sin(slope) / 7 or g * (math.sin(slope) - mu * math.cos(slope))

expect { "error of the speed", below = 1e-3, source = this.speed,
	function(run) return math.abs(run[ball].velocity:dot(down) / (a * run.time) - 1) end }
expect { "error of the way", below = 1e-3, source = this.way,
	function(run) return math.abs(run[ball].moved:dot(down) / (.5 * a * run.time * run.time) - 1) end }
