-- Long rods side by side, across the axes: the AABB of each overlaps all others, but no two touch. A step has little
-- work with them, a measure of their penetration would check all pairs. The spheres raise the limit of pairs, which
-- grows with the scene.
scene { gravity = { 0, 0, 0 } }
for i = 0, 739 do
	cylinder { radius = .01, length = 100, at = { .03 * (i % 40), .03 * (i // 40), 0 }, q = { .88, .325, -.325, 0 } }
end
for i = 1, 4000 do
	sphere { radius = .1, static = true, at = { 1e4 + i, 0, 0 } }
end
