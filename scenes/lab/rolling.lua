-- SimBenchmark's rolling test: a pushed box, and spheres that roll on it.
local about = "A box of 20 x 20 x 1 m and 10 kg on the ground (friction .4) is pushed by 150 N; 25 spheres of 1 kg roll on it "
	.. "(friction .8); 4 s. The force goes along "
local this = case { row = 9, variants = {
	{
		name = "rolling-diagonal", title = "Rolling, pushed aslant", compared = true, way = vector(.5, .86602540378443865, 0),
		setup = about .. "(1/2, sqrt(3)/2).",
		others = "Jolt 9e-4; Box3D 1e-6 at 240 Hz; ODE 3.1: nothing moves",
	}, {
		name = "rolling-y", title = "Rolling, pushed along y", way = vector(0, 1, 0),
		setup = about .. "y.",
		others = "Jolt 9e-4; Box3D 1e-6 at 240 Hz",
	},
} }
scene { title = this.title, duration = 4 }
local push, g, balls = 150, 9.81, 25
ground { friction = .2 } -- with the box's .8: .4
local pushed = box { size = { 20, 20, 1 }, mass = 10, at = { 0, 0, .5 - 2e-5 }, friction = .8, force = push * this.way }
local ball
for i = 0, balls - 1 do
	local name = sphere { radius = .5, mass = 1, at = { 2 * (i // 5) - 4, 2 * (i % 5) - 4, 1.5 - 6e-5 }, friction = .8 }
	ball = ball or name
end

-- Accelerations, by the friction on the ground and on a ball.
local on_ground = .4 * (10 + balls * 1) * g
local on_ball = (push - on_ground) / 10 / (3.5 / 1 + balls / 10)
local box_a, ball_a = (push - on_ground - balls * on_ball) / 10, on_ball / 1

local function squared(v) return v:dot(v) end
local frames, mean = -1, 0
watch(function(run)
	local error = squared(run[pushed].velocity - box_a * run.time * this.way)
		+ squared(run[ball].velocity - ball_a * run.time * this.way)
	frames = frames + 1
	if frames > 0 then mean = mean + (error - mean) / frames end
end)
expect { "mean squared error of velocities", below = 1e-6, unit = "m^2/s^2",
	source = "SimBenchmark's rolling test (Kang and Hwangbo 2018)", function(run)
		if run[pushed].moved:aside() < .1 then run:fail("nothing moved") end
		return mean
	end }
