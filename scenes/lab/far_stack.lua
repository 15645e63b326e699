-- Far from the origin, where positions have fewer digits: the same stack twice in one world, at the origin and 10 km away. Each
-- has a slab of its own, before it in the order of ids, so that only the place differs.
case { name = "far-stack", row = 23, setup = "The stack of 10 at the origin and the same 10 km away; 20 s." }
scene { title = "Stack of 10 at 10 km", duration = 20 }

local function stack(foot)
	local random = lab.splitmix(14)
	local part = { [0] = box { size = { 10, 10, 1 }, at = foot + vector(0, 0, -.5), static = true } }
	for i = 0, 9 do
		local x, y = random.within(-.01, .01), random.within(-.01, .01)
		part[i + 1] = box { size = { 1, 1, 1 }, mass = 1000, at = foot + vector(x, y, .5 + i) }
	end
	return part
end
local near, far = stack(vector(0, 0, 0)), stack(vector(10e3, 0, 0))

local function depth(run, part) return (run:penetration(part[0], part[10])) end
expect { "worst penetration at 10 km", below = .5, unit = "mm", source = "no penetration", worst = true,
	function(run) return 1e3 * depth(run, far) end }
expect { "difference of ways", below = 1e-6, unit = "m", source = "the stack at the origin", worst = true, function(run)
	local most = 0
	for i = 1, 10 do most = math.max(most, (run[far[i]].moved - run[near[i]].moved):norm()) end
	return most
end }
expect { "difference of penetrations", below = 1e-6, unit = "m", source = "the stack at the origin", worst = true,
	function(run)
		if lab.farthest(run) > .25 then run:fail("fell") end
		return math.abs(depth(run, far) - depth(run, near))
	end }
