-- Pyramids whose cubes do not touch their neighbours.
local this = case { row = 16, variants = {
	{
		name = "pyramid-10", title = "Pyramid of 10 rows", rows = 10,
		setup = "55 cubes of 1 m and 1000 kg in ten rows, 50 mm between neighbours, friction .5; 20 s.",
		others = "sag of 12 to 23 mm",
	}, {
		name = "pyramid-15", title = "Pyramid of 15 rows", rows = 15,
		setup = "120 cubes of 1 m and 1000 kg in fifteen rows, 50 mm between neighbours, friction .5; 20 s.",
		others = "sag of 12 to 23 mm",
	},
} }
scene { title = this.title, duration = 20 }
ground {}
for row = 0, this.rows - 1 do
	for i = 0, this.rows - row - 1 do
		box { size = { 1, 1, 1 }, mass = 1000, at = { 0, 1.05 * (i - .5 * (this.rows - row - 1)), .5 + row } }
	end
end
lab.stands { worst = .5, drift = 1 }
