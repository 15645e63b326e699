-- Columns of four boxes, 1.8 m apart, of random sizes and attitudes. The lowest are between 2.8 and 3.8 m up.
local this = case {
	name = "falling-100", row = 17, runs = 5,
	setup = "Columns of four boxes with half extents of .1 to .5 m, turned at random, drop on the ground; friction .5; 10 s; "
		.. "the worst of five such.",
	others = "worst of 1000 such: Box3D 213 mm, Jolt 215 mm, ODE 309 mm, Bullet 606 mm",
}
scene { title = "100 falling boxes", duration = 10 }
local random, z = lab.splitmix(100 + this.run), nil
ground {}
for i = 0, 99 do
	local column = i // 4
	z = (i % 4 > 0 and z or 1) + 1.8 + random.real()
	local half = vector(.3, .3, .3) + random.vector(.2)
	box { size = 2 * half, mass = 8000 * half.x * half.y * half.z, at = { 1.8 * (column % 5), 1.8 * (column // 5), z },
		q = random.rotation() }
end
lab.heap({ growth = 1e-5 }, 10)
