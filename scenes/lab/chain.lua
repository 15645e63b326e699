-- A chain of 100 links of .1 m and .01 kg with 10 kg at its end. Energy is a measure of the motion that needs no reference: it falls
-- from the start to the lowest place by the swing's.
case {
	name = "chain-100", row = 48, slow = true, compared = true,
	setup = "100 links of .01 kg with 10 kg at the end swing from 11 degrees; 2 s.",
}
scene { title = "Chain of 100 under a load", duration = 2 }
local g, links, link, lean = 9.81, 100, .1, .2
local at, last = vector(0, 0, 0), nil
local function hanging(by) return at + by * vector(math.sin(lean), 0, -math.cos(lean)) end
for _ = 1, links do
	local part = capsule { radius = .01, length = .08, mass = .01, at = hanging(link / 2),
		q = rotation(math.cos(lean / 2), 0, -math.sin(lean / 2), 0) }
	ball { part, last, at = at }
	at, last = hanging(link), part
end
local load = sphere { radius = .1, mass = 10, at = hanging(.1) }
ball { load, last, at = at }

local length, start = .1 * links, nil
local lift = g * (1 - math.cos(lean)) * (10 * (length + .1) + .01 * links * length / 2)
lab.held(1e-4, "constant; over that of the swing", function(run)
	start = start or run.energy
	return math.abs(run.energy - start) / lift
end, "error of energy", "1")
