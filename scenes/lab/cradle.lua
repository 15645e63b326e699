-- Newton's cradle in free space: incoming balls touch each other, as do those at rest, .7 m behind.
local this = case { row = 3, variants = {
	{
		name = "cradle-1", title = "Newton's cradle, one comes in", come = 1,
		setup = "Five equal elastic spheres in a row: four touch and rest, one comes in at 1 m/s.",
		others = "all fail: the last leaves at .40 to .55 of the speed; some gain energy",
	}, {
		name = "cradle-2", title = "Newton's cradle, two come in", come = 2,
		setup = "Five equal elastic spheres in a row: three touch and rest, two that touch come in at 1 m/s.",
		others = "all fail: .40 to .55 of the speed; some gain energy",
	},
} }
scene { title = this.title, duration = 3, gravity = { 0, 0, 0 } }
local ball = {}
for i = 0, 4 do
	local comes = i < this.come
	ball[i] = sphere { radius = .5, mass = 1, at = { i + (comes and 0 or .7), 0, 0 }, velocity = { comes and 1 or 0, 0, 0 },
		friction = 0, restitution = 1 }
end

expect { "error of velocities", below = 1e-9, source = "as many leave as came in (Herrmann and Seitz 1982)", function(run)
	local worst = 0
	for i = 0, 4 do
		local exact = vector(i < 5 - this.come and 0 or 1, 0, 0)
		worst = math.max(worst, (run[ball[i]].velocity - exact):norm())
	end
	return worst
end }
local start
expect { "gain of energy", below = 1e-9, source = "energy at the start", worst = true, function(run)
	start = start or run.energy
	return run.energy / start - 1
end }
