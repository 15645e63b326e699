-- Heaps of all shapes, turned at random, in a loose grid.
local this = case { slow = true, variants = {
	{
		name = "mixed-pile", row = 37, title = "Pile of 200 of all shapes", duration = 5, count = 200, side = 6, seed = 200,
		setup = "200 boxes, cylinders, spheres and capsules of .24 to .5 m, turned at random, drop in a loose grid; friction .5, no "
			.. "restitution; 5 s.",
	}, {
		name = "random-heaps", row = 38, title = "A hundred random heaps", duration = 2, runs = 100, count = 24, side = 3, seed = 3800,
		setup = "24 boxes, cylinders, spheres and capsules at random drop on the ground, a hundred times; friction .5, no "
			.. "restitution; 2 s each. Of engines without a tolerance 1 mm is asked.",
	},
} }
scene { title = this.title, duration = this.duration }
local random, side, apart = lab.splitmix(this.seed + this.run), this.side, .6 -- m: the longest are .54 m, and are drawn up to .02 m off
local kinds = {
	[0] = function(b) b.size, b.mass = { .4, .3, .2 }, 24; box(b) end,
	function(b) b.radius, b.length, b.mass = .15, .4, 28; cylinder(b) end,
	function(b) b.radius, b.mass = .18, 24; sphere(b) end,
	function(b) b.radius, b.length, b.mass = .12, .3, 20; capsule(b) end,
}
ground {}
for i = 0, this.count - 1 do
	local p = vector(apart * (i % side - .5 * (side - 1)), apart * (i // side % side - .5 * (side - 1)),
		.5 + apart * (i // side // side)) + random.vector(.02)
	local kind = random.whole() & 3
	kinds[kind] { at = p, q = random.rotation() }
end

if this.name == "mixed-pile" then
	lab.heap({ mean = .5, settled = 1, worst = 1, growth = 1e-5 }, 5)
else -- how often they meet the tolerance
	local depth = 0
	watch(function(run)
		depth = math.max(depth, 1e3 * run:penetration())
		lab.fell(run)
	end)
	expect { "share above the tolerance", below = .01, mean = true, source = "none: deepest that two bodies ever are in each other",
		function(run)
			local tolerance = run.tolerance > 0 and run.tolerance or 1e-3
			local moved = lab.farthest(run) > .1
			if not moved then run:fail("nothing moved") end
			return (not moved or depth > 1e3 * tolerance) and 1 or 0
		end }
	expect { "worst penetration at any moment", unit = "mm", source = "no penetration", function() return depth end }
end
