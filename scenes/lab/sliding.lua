-- Blocks that slide in all directions until they stop. All are in one world, 4 m apart. Headings are 15 degrees apart, every
-- other one reversed: along both axes and both diagonals, and into every quadrant.
case {
	row = 11,
	setup = "Twelve boxes of 1 x 1 x .5 m start at 3 m/s in as many directions; friction .5; 1 s.",
	others = "Box3D -.4 %; ODE -31 % along the diagonal",
}
scene { title = "Sliding in all directions", duration = 1 }
local g, mu, speed, headings = 9.81, .5, 3, 12
ground { friction = mu }
local block = {}
for i = 0, headings - 1 do
	local heading = i * math.pi / 12 + (i % 2 == 1 and math.pi or 0)
	block[i + 1] = box { size = { 1, 1, .5 }, mass = 500, at = { 4 * i, 0, .25 }, friction = mu,
		velocity = { speed * math.cos(heading), speed * math.sin(heading), 0 } }
end

-- A block stops between frames: when its last speed has fallen to 0 at its deceleration.
local last, stops = {}, {}
watch(function(run)
	for i, name in ipairs(block) do
		local v = run[name].velocity:norm()
		local lost = (last[i] or 0) - v
		if run.time > 0 and v > .05 * speed and lost > 0 then stops[i] = run.time + v / lost * run.step end
		last[i] = v
	end
end)

local way, time = speed * speed / (2 * mu * g), speed / (mu * g)
local function worst_of(run, f)
	local worst = 0
	for i, name in ipairs(block) do worst = math.max(worst, f(i, run[name])) end
	return worst
end
local function level(v) return vector(v.x, v.y, 0) end

expect { "worst error of the way", below = 1e-3, source = "v^2 / (2 mu g) (Coulomb 1785)", function(run)
	lab.fell(run)
	return worst_of(run, function(_, b) return (level(b.moved) - way / speed * b.start.velocity):norm() / way end)
end }
expect { "worst error of the time", below = 1e-3, source = "v / (mu g) (Coulomb 1785)",
	function(run) return worst_of(run, function(i) return math.abs((stops[i] or 0) / time - 1) end) end }
expect { "spread of the ways", below = 1e-3, source = "the same in all directions", function(run)
	local least, most = math.huge, 0
	for _, name in ipairs(block) do
		local went = run[name].moved:aside()
		least, most = math.min(least, went), math.max(most, went)
	end
	return (most - least) / way
end }
