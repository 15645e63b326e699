-- A block on a slope just below and just above the angle of friction.
local this = case { row = 10, variants = {
	{
		name = "incline-stick", title = "Block sticks on a slope", share = .99, duration = 10,
		setup = "A box of 1 x 1 x .5 m on a slope of .99 of the angle of friction, friction .5; 10 s.",
		others = "ODE creeps 1.5 mm",
	}, {
		name = "incline-slide", title = "Block slides down a slope", share = 1.01, duration = 4,
		setup = "A box of 1 x 1 x .5 m on a slope of 1.01 of the angle of friction, friction .5; its way after 4 s.",
		others = "ODE +7.3 %",
	},
} }
scene { title = this.title, duration = this.duration }
local g, mu = 9.81, .5
local angle = this.share * math.atan(mu)
local tilt = rotation(vector(0, angle, 0))
plane { q = tilt, friction = mu }
local block = box { size = { 1, 1, .5 }, mass = 500, at = .25 * tilt:axis "z", q = tilt, friction = mu }

-- Displacement along the slope, downwards and sideways, m.
local function crept(run)
	local moved = run[block].moved
	return moved:dot(tilt:axis "x"), moved:dot(tilt:axis "y")
end

if this.name == "incline-stick" then
	expect { "creep", below = .01, unit = "mm", source = "none (Coulomb 1785)", worst = true, function(run)
		local down, aside = crept(run)
		if math.abs(run[block].moved:dot(tilt:axis "z")) > .1 then run:fail("left the slope") end
		return 1e3 * vector(down, aside, 0):aside()
	end }
else
	expect { "error of the way", below = .003, source = "g (sin - mu cos) t^2 / 2 (Coulomb 1785)", function(run)
		local down, aside = crept(run)
		local exact = .5 * (g * (math.sin(angle) - mu * math.cos(angle))) * run.time * run.time
		if vector(down, aside, 0):aside() < .01 * exact then run:fail("nothing moved") end
		return vector(down - exact, aside, 0):aside() / exact
	end }
end
