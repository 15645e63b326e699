-- A wall hit by a ball every half second: none of its bodies rests for longer, so an engine that skips bodies in equilibrium gains
-- little. A constant force balances the weight of a ball, so that it flies on a straight line, from alternating sides, each towards
-- another brick. It bounces off, and its way back is free.
local this = case {
	name = "hit-wall", row = 26, runs = 5, compared = true,
	setup = "A wall of 27 bricks of 1 x .5 x .5 m and 500 kg, six rows in bond, friction .5, is hit every half second by a "
		.. "weightless ball of 20 kg at 6 m/s, e = .5, from one side and from the other; 10 s; the worst of five such.",
	others = "not measured by others",
}
scene { title = "Wall hit every half second", duration = 10 }
local every, speed, radius, mass, half = .5, 6, .15, 20, .25 -- half: m, of a brick's depth
local random, brick, ball, at = lab.splitmix(25 + this.run), {}, {}, {}
ground {}
for row = 0, 5 do
	local bricks = 5 - row % 2
	for i = 0, bricks - 1 do
		at[#at + 1] = vector((2 * .5 + .01) * (i - .5 * (bricks - 1)), 0, half * (2 * row + 1))
		brick[#at] = box { size = { 1, .5, .5 }, mass = 500, at = at[#at] }
	end
end

-- Shuffles the bricks for each run (Fisher and Yates).
local aim = {}
for i = 0, 26 do
	local j = math.tointeger(random.real() * (i + 1) // 1)
	aim[i] = aim[j]
	aim[j] = 1 + i
end
for k = 0, 18 do
	local side, way = k % 2 == 1 and 1 or -1, half + radius + speed * every * (k + 1)
	local target = at[aim[k]] + random.vector(.05)
	ball[k + 1] = sphere { radius = radius, mass = mass, at = { target.x, side * way, target.z }, velocity = { 0, -side * speed, 0 },
		force = -mass * vector(0, 0, -9.81), restitution = .5 }
end

local lowest, growth, drift, fallen = nil, 0, 0, 0
watch(function(run)
	local energy = run.energy
	for _, name in ipairs(ball) do -- the balls' own force has a potential, too
		energy = energy - (-mass * vector(0, 0, -9.81)):dot(run[name].at)
	end
	lowest = math.min(lowest or energy, energy)
	growth = math.max(growth, (energy - lowest) / (.5 * mass * speed * speed))
	fallen = 0
	for _, name in ipairs(brick) do
		local moved = run[name].moved
		drift = math.max(drift, 1e3 * moved:aside())
		if moved:norm() > .25 then fallen = fallen + 1 end
	end
	if fallen > 0 then run:fail("fell") end
end)
expect { "worst penetration", below = .5, unit = "mm", source = "no penetration", worst = true,
	function(run) return 1e3 * run:penetration() end }
expect { "growth of energy", below = .1, source = "none: largest rise from its lowest so far, over that of a ball",
	function() return growth end }
expect { "drift", unit = "mm", source = "what the hits and Coulomb's friction leave: farthest that a brick gets aside",
	function() return drift end }
expect { "bricks that fell", below = 0, source = "none: a hit moves a brick by millimetres", function() return fallen end }
expect { "balls that did not bounce", below = 0, source = "each of the 19 hits, and flies back", function(run)
	local missed = 0
	for _, name in ipairs(ball) do -- one has hit once it flies back
		local b = run[name]
		if b.velocity.y * b.start.velocity.y > -.01 then missed = missed + 1 end
	end
	return missed
end }
