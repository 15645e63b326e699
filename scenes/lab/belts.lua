-- Boxes on conveyor belts.
case {
	row = 40,
	setup = "Boxes are put down on four belts of .5 to 3 m/s, friction .3; when they have the belt's speed, and their way; 2 s.",
}
scene { title = "Boxes on conveyor belts", duration = 2 }
local g, mu, speed, carried = 9.81, .3, { .5, 1, 2, 3 }, {}
for i, v in ipairs(speed) do
	box { size = { 12, 1, .2 }, at = { 4, 3 * (i - 1), -.1 }, friction = mu, static = true, surface_velocity = { v, 0, 0 } }
	carried[i] = box { size = { .4, .4, .4 }, mass = 5, at = { 0, 3 * (i - 1), .2 }, friction = mu }
end

-- A box has the belt's speed between frames: when its last speed has grown so far at its acceleration.
local last, reaches = { 0, 0, 0, 0 }, { 0, 0, 0, 0 }
watch(function(run)
	for i, name in ipairs(carried) do
		local v = run[name].velocity.x
		if reaches[i] == 0 and v > (1 - 1e-6) * speed[i] then reaches[i] = run.time - run.step + (speed[i] - last[i]) / (mu * g) end
		last[i] = v
	end
end)
local function worst_of(f)
	local worst = 0
	for i = 1, 4 do worst = math.max(worst, f(i, speed[i])) end
	return worst
end
expect { "error of the time to the belt's speed", below = .01, source = "v / (mu g) (Coulomb 1785)",
	function() return worst_of(function(i, v) return math.abs(reaches[i] / (v / (mu * g)) - 1) end) end }
expect { "error of the way", below = .01, source = "v t - v^2 / (2 mu g)", function(run)
	return worst_of(function(i, v)
		local way = v * run.time - v * v / (2 * mu * g)
		return (run[carried[i]].moved - vector(way, 0, 0)):norm() / way
	end)
end }
