-- A ball that bounces on the ground, without loss and with it.
local this = case { variants = {
	{
		name = "bounce", row = 4, title = "Bouncing ball, e = 1", radius = .5, e = 1, compared = true,
		duration = 90, -- the hundredth comes after 199 sqrt(2 h / g) = 89.9 s
		setup = "A sphere of radius .5 m is dropped from 1 m on a fixed ground and bounces a hundred times.",
		others = "ODE loses 62 % at 240 Hz",
	}, {
		name = "apexes", row = 5, title = "Heights of a ball, e = .8", radius = .1, e = .8,
		duration = 2.5, -- the fifth impact comes at 2.58 s
		setup = "A sphere of radius .1 m is dropped from 1 m with restitution .8; its next four highest points.",
		others = "-12 % to +81 %",
	},
} }
scene { title = this.title, duration = this.duration }
local g = 9.81
material "all" { friction = .5, restitution = this.e }
ground { material = "all" }
local ball = sphere { radius = this.radius, mass = 1, at = { 0, 0, 1 + this.radius }, material = "all" }

-- Turns from falling to rising.
local bounces, last, start = 0, 0, nil
watch(function(run)
	local v = run[ball].velocity.z
	if last < 0 and v > 0 then bounces = bounces + 1 end
	last, start = v, start or run.energy
end)

local function check(run)
	if not lab.fell(run) and bounces < 1 then run:fail("never bounced") end
end

if this.name == "bounce" then
	expect { "error of energy", below = 1e-12, source = "energy at the start, over that of the drop", worst = true,
		function(run) return math.abs(run.energy - start) / g end }
	expect { "bounces too many or too few", below = 0, source = "drop and rebound take 2 sqrt(2 h / g) (Galilei 1638)",
		function(run)
			check(run)
			return math.abs(bounces - 100)
		end }
else
	-- Apex of each flight, from its highest frame: the rest of the rise is v^2 / 2 g.
	local highest, apex = {}, {}
	watch(function(run)
		local bottom = run[ball].at.z - this.radius
		if bottom > (highest[bounces] or 0) then
			highest[bounces], apex[bounces] = bottom, bottom + last * last / (2 * g)
		end
	end)
	expect { "worst error of height", below = 1e-9, unit = "m", source = "h e^(2 k) (Newton 1687)", function(run)
		local worst = 0
		for k = 1, 4 do worst = math.max(worst, math.abs((apex[k] or 0) - this.e ^ (2 * k))) end
		check(run)
		return worst
	end }
end
