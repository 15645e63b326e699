-- A door that a motor turns faster and faster until its hinge breaks.
case {
	name = "breaking-door", row = 53,
	setup = "A torque of 30 N m turns a door of 20 kg faster and faster; its hinge holds 900 N.",
}
scene { title = "Door that breaks off", duration = 3 }
local g, half, torque, strength, mass = 9.81, .5, 30, 900, 20
local door = box { size = { 2 * half, .06, 2 }, mass = mass, at = { half, 0, 3 } }
hinge { door, at = { 0, 0, 3 }, q = rotation(1, 0, 0, 0), motor = { rate = 1e3, most = torque }, breaks_at = { force = strength } }

local function speed_of(b) return b.velocity:aside() end
local function acceleration_of(b) return torque / (b.inertia.z + mass * half * half) end
expect { "error of the instant", below = 1 / 480, unit = "s", source = "m r^2 (w^4 + a^2) + g^2 m^2 = F^2; within a substep",
	function(run)
		local b = run[door]
		local acceleration = acceleration_of(b)
		local across = mass * acceleration * half
		local inward = math.sqrt(strength * strength - across * across - mass * g * (mass * g))
		return math.abs(speed_of(b) / half - math.sqrt(inward / (mass * half))) / acceleration
	end }
expect { "turn after it, off speed / radius", below = 1e-6, unit = "rad/s", source = "it flies as it was",
	function(run) return math.abs(speed_of(run[door]) / half - run[door].spin.z) end }
expect { "fall after it", below = .02, unit = "m/s", source = "g t, from the instant found", function(run)
	local b = run[door]
	return math.abs(b.velocity.z + g * (run.time - speed_of(b) / half / acceleration_of(b)))
end }
