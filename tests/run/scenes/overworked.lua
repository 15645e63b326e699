-- A column of sliding bricks, heavy on light: with the largest numbers of substeps and iterations, in a single step.
scene { step = 1 / 60, substeps = 1000, iterations = 100000 }
ground {}
for i = 1, 40 do
	box { name = "brick " .. i, size = { 1, 1, 1 }, at = { .02 * (i % 3), .02 * (i % 2), i - .5 }, mass = 10 ^ (i % 7),
		velocity = { 5, 3, -2 } }
end
