-- Bricard's linkage: six links of 1 m, six hinges, each across the next; the angles of all odd hinges are alike, and those of all even
-- ones. The link between the hinges 0 and 1 stands still.
case {
	row = 52,
	setup = "Six links of 1 m in a ring of six hinges, each across the next: it moves, although 30 rows hold 30 freedoms. One hinge "
		.. "turns at .6 rad/s for 1.2 s.",
}
scene { title = "Bricard's linkage", duration = 1.2 }
local first_angle, rate, root = -1.2, -.6, math.sqrt(.5) -- rad; rad/s of the driven hinge, an odd one

-- Angle of the even hinges at that of the odd ones, and the other way round: cos a + cos b + cos a cos b = 0 (Chen, You and Tarnai
-- 2005).
local function other_angle(angle) return math.acos(-math.cos(angle) / (1 + math.cos(angle))) end

-- Place and attitude of the hinges' frames: each is the one before turned by its angle, 1 m along x, turned by a right angle about x.
local at, q = { [0] = vector(0, 0, 0) }, { [0] = rotation(1, 0, 0, 0) }
for i = 0, 5 do
	local angle, way = i % 2 == 1 and first_angle or other_angle(first_angle), i % 2 == 1 and -1 or 1
	local turned = q[i] * rotation(math.cos(angle / 2), 0, 0, math.sin(angle / 2))
	local r = turned * rotation(root, way * root, 0, 0)
	at[i + 1], q[i + 1] = at[i] + turned:axis "x", rotation(r.w, r.x, r.y, r.z)
end
local link, joint = {}, {}
for i = 1, 5 do link[i] = sphere { radius = .1, mass = 1, at = .5 * (at[i] + at[i + 1]) } end
for i = 1, 6 do -- the last one is hinge 0
	joint[i] = hinge { link[i] or link[i - 1], link[i] and link[i - 1], at = at[i], q = q[i],
		motor = i == 1 and { rate = rate } or nil }
end

lab.held(1e-9, "cos a + cos b + cos a cos b = 0 (Chen, You and Tarnai 2005)", function(run)
	local even, worst = other_angle(first_angle + rate * run.time) - other_angle(first_angle), 0
	for i = 1, 6 do
		local angle = run:joint(joint[i])
		worst = math.max(worst, math.abs((i < 6 and 1 or -1) * angle - (i % 2 == 0 and even or rate * run.time)))
	end
	return worst
end, "error of an angle", "rad")
