-- Structures with many cycles that stand for a minute, awake. No motion in them is fast: looked at six times a second.
local this = case { row = 35, variants = {
	{
		name = "crib-tower", title = "Crib tower of 200 planks",
		setup = "200 planks of 1.2 x .24 x .08 m, two a layer and crosswise, friction .5, stand for 60 s, awake.",
	}, {
		name = "touching-pyramid", title = "Pyramid of 120 that touch",
		setup = "120 cubes of 1 m and 1000 kg in fifteen rows, neighbours touching, friction .5, stand for 60 s, awake.",
	},
} }
scene { title = this.title, duration = 60 }
ground {}
if this.name == "crib-tower" then
	for layer = 0, 99 do -- two planks each, across those below
		for side = -1, 1, 2 do
			local z, off = .04 * (2 * layer + 1), side * .45
			local across = layer % 2 == 1
			box { size = across and { .24, 1.2, .08 } or { 1.2, .24, .08 }, mass = 14, at = across and { off, 0, z } or { 0, off, z } }
		end
	end
else
	for row = 0, 14 do
		for i = 0, 14 - row do
			box { size = { 1, 1, 1 }, mass = 1000, at = { 0, i - .5 * (15 - row - 1), .5 + row } }
		end
	end
end
lab.stands { worst = .5, drift = .1, every = 10 }
