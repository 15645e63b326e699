-- A sphere that slips until it rolls.
case { name = "slip-to-roll", row = 12, setup = "A sphere is set down at 7 m/s without spin; friction .2; 3 s." }
scene { title = "From slipping to rolling", duration = 3 }
local g, mu, v = 9.81, .2, 7
ground { friction = mu }
local ball = sphere { radius = .5, mass = 10, at = { 0, 0, .5 }, velocity = { v, 0, 0 }, friction = mu }

-- Rolling begins between frames: when the last slip has fallen to 0 at its rate.
local last, rolls = 0, 0
watch(function(run)
	local b = run[ball]
	local slip = b.velocity.x - b.spin.y * .5
	local lost = last - slip
	if run.time > 0 and slip > .05 * v and lost > 0 then rolls = run.time + slip / lost * run.step end
	last = slip
end)
expect { "error of the final speed", below = 1e-3, source = "5/7 v (Routh 1905)",
	function(run) return math.abs(run[ball].velocity.x / (5 * v / 7) - 1) end }
expect { "error of the time when it rolls", below = 1e-3, source = "2 v / (7 mu g) (Routh 1905)", function(run)
	lab.fell(run)
	return math.abs(rolls / (2 * v / (7 * mu * g)) - 1)
end }
