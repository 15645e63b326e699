-- Long rods side by side, across the axes: each one's box overlaps those of all others, of which none touches it. A step
-- has little work with them, a measure of their penetration would have to look at all pairs. The spheres are there since
-- a larger scene may have more pairs.
scene { gravity = { 0, 0, 0 } }
for i = 0, 739 do
	cylinder { radius = .01, length = 100, at = { .03 * (i % 40), .03 * (i // 40), 0 }, q = { .88, .325, -.325, 0 } }
end
for i = 1, 4000 do
	sphere { radius = .1, static = true, at = { 1e4 + i, 0, 0 } }
end
