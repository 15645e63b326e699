-- Stacks of equal cubes, and stacks with a heavy one on top.
local of_five = "the worst of five such."
local this = case { runs = 5, variants = {
	{
		name = "stack-10", row = 14, title = "Stack of 10", cubes = 10, top = 1, compared = true, worst = .5,
		setup = "Ten cubes of 1 m and 1000 kg, each up to 10 mm off the axis, friction .5, stand for 20 s, awake; " .. of_five,
		others = "sag at 240 Hz: Bullet .68 mm, Jolt .84 mm, ODE 1.16 mm, Box3D 25.5 mm",
	}, {
		name = "stack-20", row = 14, title = "Stack of 20", cubes = 20, top = 1, worst = .5, drift = 1,
		setup = "As the stack of 10, with twenty cubes.",
		others = "at 60 Hz it falls in Jolt, Bullet and ODE; Box3D sags 106 mm",
	}, {
		name = "stack-40", row = 14, title = "Stack of 40", cubes = 40, top = 1, worst = .5, drift = 10,
		setup = "As the stack of 10, with forty cubes.",
		others = "at 60 Hz already a stack of 20 falls in Jolt, Bullet and ODE",
	}, {
		name = "heavy-100", row = 15, title = "100 : 1 on one cube", cubes = 2, top = 100, worst = .6,
		setup = "A cube of 100 t on a cube of 1 t, both of 1 m, up to 10 mm off the axis, friction .5; 20 s; " .. of_five,
		others = "not measured at 100 : 1",
	}, {
		name = "heavy-1000", row = 15, title = "1000 : 1 on one cube", cubes = 2, top = 1000, compared = true, worst = 2,
		setup = "A cube of 1000 t on a cube of 1 t, both of 1 m, up to 10 mm off the axis, friction .5; 20 s; " .. of_five,
		others = "falls in Jolt, Bullet and ODE's QuickStep; Box3D fails",
	}, {
		name = "heavy-on-stack", row = 15, title = "100 : 1 on a stack of 10", cubes = 11, top = 100,
		setup = "A cube of 100 t on a stack of ten cubes of 1 t, all of 1 m, up to 10 mm off the axis, friction .5; 20 s; "
			.. of_five,
		others = "1000 : 1 on one cube falls in Jolt, Bullet and ODE's QuickStep",
	},
} }
scene { title = this.title, duration = 20 }
local random = lab.splitmix(14 + this.run)
ground {}
for i = 0, this.cubes - 1 do
	local x, y = random.within(-.01, .01), random.within(-.01, .01)
	local heavy = i == this.cubes - 1 and this.top or 1
	local moment = 1000 / 3 * (.25 + .25) * heavy
	box { size = { 1, 1, 1 }, at = { x, y, .5 + i }, mass = 1000 * heavy, inertia = { moment, moment, moment } }
end
lab.stands { worst = this.worst, drift = this.drift }
