-- Stacks and piles that a table keeps from coming to rest. Its top is at z = 0; it swings along x, starting at rest at one end.
local this = case { row = 42, runs = 5, compared = true, variants = {
	{
		name = "shaken-stack", title = "Shaken stack of 10", duration = 20, half = 2, acceleration = .3 * 9.81,
		setup = "Ten slabs of 1 x 1 x .25 m and 250 kg, each up to 10 mm off the axis, friction .5, ride on a table that goes to and "
			.. "fro by .1 m at up to .3 g; nothing slips or tips, and nothing ever rests; 20 s; the worst of five such.",
	}, {
		name = "shaken-pile", title = "Shaken pile of 64", duration = 10, half = 15, acceleration = .6 * 9.81, slow = true,
		setup = "64 boxes of .5 m in a loose grid, slightly turned, drop half a metre on a table that goes to and fro by .1 m at up "
			.. "to .6 g; friction .5, so that they slip all the time; 10 s; the worst of five such.",
	},
} }
scene { title = this.title, duration = this.duration }
local amplitude = .1
local frequency = math.sqrt(this.acceleration / amplitude) -- rad/s
box { size = { 2 * this.half, 2 * this.half, 1 }, at = { -amplitude, 0, -.5 }, kind = "kinematic",
	path = { kind = "sine", amplitude = { amplitude, 0, 0 }, rate = frequency, phase = math.acos(0) } }

if this.name == "shaken-stack" then
	local random = lab.splitmix(4200 + this.run)
	for i = 0, 9 do
		local off = random.vector(.01)
		box { size = { 1, 1, .25 }, mass = 250, at = { off.x, off.y, .125 + .25 * i } }
	end
	lab.stands { worst = .5, drift = 1, creep = "creep", meaning = "it rides along: farthest that a body is aside of where the table takes it",
		holds = "none: friction and width hold all of it",
		carried = function(t) return vector(amplitude * (math.cos(frequency * t) - 1), 0, 0) end }
else
	local random = lab.splitmix(4250 + this.run)
	for i = 0, 63 do
		local p = vector((i % 4 - 1.5) * .75, (i // 4 % 4 - 1.5) * .75, .75 + .8 * (i // 16)) + random.vector(.05)
		box { size = { .5, .5, .5 }, mass = 125, at = p, q = rotation(random.vector(.15)) }
	end
	lab.heap({ mean = .5, settled = 2, worst = 2, growth = false, ground = false,
		names = { "mean penetration in the last second", "worst penetration in the last second" } }, 10)
end
