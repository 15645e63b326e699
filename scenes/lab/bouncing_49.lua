-- SimBenchmark's bouncing test.
case {
	name = "bouncing-49", row = 6,
	setup = "7 x 7 elastic spheres of radius .1 m and 10 kg, 2 m apart, fall from a height of 5 m without friction; 20 s.",
	others = "at 1 ms: RaiSim .019 J^2, ODE 185 J^2",
}
scene { title = "SimBenchmark's bouncing test", duration = 20 }
material "all" { friction = 0, restitution = 1 }
ground { material = "all" }
local ball = {}
for i = 0, 48 do
	ball[i] = sphere { radius = .1, mass = 10, at = { 2 * (i % 7), 2 * (i // 7), 5 }, material = "all" }
end

local mean, frames, bounced, last = 0, 0, false, 0
watch(function(run)
	local error, v = run.energy - 49 * 10 * 9.81 * 5, run[ball[0]].velocity.z
	bounced, last = bounced or last < 0 and v > 0, v
	if frames > 0 then mean = mean + (error * error - mean) / frames end
	frames = frames + 1
	lab.fell(run)
end)
expect { "mean squared error of energy", below = 1e-8, unit = "J^2", source = "49 m g h (Kang and Hwangbo 2018)",
	function(run)
		if not lab.fell(run) and not bounced then run:fail("never bounced") end
		return mean
	end }
