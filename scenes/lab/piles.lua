-- Boxes that drop in a loose grid: .25 and .3 m between them, displaced by up to 5 cm and turned by up to .15 rad about each
-- axis. The lowest centres are half a metre above their final place. Dropping is chaotic: five runs, and the worst counts.
local this = case { row = 17, runs = 5, variants = {
	{
		name = "pile", title = "Pile of 216 boxes", e = 0, compared = true,
		setup = "216 boxes of .5 m in a loose grid of 6 x 6 x 6, slightly turned, drop half a metre; friction .5, no "
			.. "restitution; 10 s; the worst of five such.",
		others = "worst impact 30 to 525 mm in every engine",
	}, {
		name = "pile-elastic", title = "Pile of 216 boxes, e = .5", e = .5,
		setup = "As the pile, with restitution .5.",
		others = "worst impact 30 to 525 mm in every engine",
	},
} }
scene { title = this.title, duration = 10 }
local random = lab.splitmix(17 + this.run)
material "all" { friction = .5, restitution = this.e }
ground { material = "all" }
for i = 0, 215 do
	local p = vector((i % 6 - 2.5) * .75, (i // 6 % 6 - 2.5) * .75, .75 + .8 * (i // 36)) + random.vector(.05)
	box { size = { .5, .5, .5 }, mass = 125, at = p, q = rotation(random.vector(.15)), material = "all" }
end
lab.heap({ mean = .5, settled = 2, worst = 2, growth = 1e-5 }, 10)
