-- Boxes on turntables, each on its own: from .9525 to 1.0525 of the radius at which friction holds them.
case {
	row = 41,
	setup = "Boxes ride on turntables of 2 rad/s, from .9525 to 1.0525 of the radius at which friction of .5 holds them, each on its "
		.. "own; the radius from which they are thrown off, and the creep of those that stay; 6 s.",
}
scene { title = "Boxes on turntables", duration = 6 }
local rate, mu, tables, rider = 2, .5, 21, {}
local limit = mu * 9.81 / (rate * rate)
local function share(i) return .9525 + .005 * i end
for i = 0, tables - 1 do
	local y, r = 6 * i, share(i) * limit
	cylinder { radius = 2.5, length = .2, at = { 0, y, -.1 }, kind = "kinematic", spin = { 0, 0, rate }, friction = mu }
	rider[i] = box { size = { .2, .2, .1 }, mass = 5, at = { r, y, .05 }, velocity = { 0, rate * r, 0 }, spin = { 0, 0, rate },
		friction = mu }
end

-- The limit lies between the last box that stays and the first that does not.
local stays, goes, crept = 0, math.huge, 0
expect { "error of the limit", below = .01, source = "mu g = rate^2 r (Coulomb 1785, Huygens 1673)", function(run)
	local c, s = math.cos(rate * run.time), math.sin(rate * run.time)
	for i = 0, tables - 1 do
		local middle = vector(0, 6 * i, -.1)
		local from, to = run[rider[i]].start.at - middle, run[rider[i]].at - middle
		local off = vector(to.x - c * from.x, to.y - s * from.x, 0):aside()
		if off < .05 then
			stays, crept = math.max(stays, share(i)), math.max(crept, off)
		else
			goes = math.min(goes, share(i))
		end
	end
	return stays < goes and math.abs(.5 * (stays + goes) - 1) or 1
end }
expect { "creep of what stays", below = .01, unit = "mm", source = "none", function() return 1e3 * crept end }
