-- A disk that rolls on its rim, its centre at rest.
case {
	name = "rolling-disk", row = 32,
	setup = "A disk of 1 m x 50 mm rolls on its rim for 3 s, at 10 degrees to the ground, its centre at rest; friction .5.",
}
scene { title = "Disk that rolls on its rim", duration = 3 }
local g, a, h, tilt, mass = 9.81, .5, .025, 10 * math.pi / 180, 10 -- a, h: m, radius and half the thickness
local across, along, s, c = a * a / 4 + h * h / 3, a * a / 2, math.sin(tilt), math.cos(tilt)
local precession = math.sqrt(g * (a * c - h * s) / (s * (across * c - along * h / a * s)))
local spin = precession * (h / a * s - c)
ground { friction = .5 }
local disk = cylinder { radius = a, length = 2 * h, mass = mass, at = { 0, 0, a * s + h * c }, q = rotation(vector(0, tilt, 0)),
	spin = { spin * s, 0, spin * c + precession }, friction = .5 }

local last, turned, start = nil, 0, nil
local function energy_of(run) return run.energy - mass * g * h end -- above that lying flat
watch(function(run)
	local up = run[disk].turn:axis "z"
	local azimuth = math.atan(up.y, up.x)
	local by = azimuth - (last or azimuth)
	if by > math.pi then by = by - 2 * math.pi elseif by < -math.pi then by = by + 2 * math.pi end
	last, turned, start = azimuth, turned + by, start or energy_of(run)
end)
expect { "error of the precession", below = 1e-3, source = "steady rolling without slip (Moffatt 2000, with thickness)",
	function(run) return math.abs(turned / run.time / precession - 1) end }
expect { "change of energy in a second", below = 2e-3, source = "none; over that above lying flat", function(run)
	lab.fell(run)
	return math.abs(1 - energy_of(run) / start) / run.time
end }
expect { "change of the tilt", source = "none", worst = true,
	function(run) return math.abs(math.acos(math.min(1, run[disk].turn:axis("z").z)) / tilt - 1) end }
