-- A drop every tenth of a second.
function on_start()
	self:wake(.1)
end

function on_wake()
	local x, y = self:position()
	sphere { radius = random(.05, .09), at = { x, y, .6 }, velocity = { random(-1, 1), random(-1, 1), random(6, 8) },
	         density = 1000, restitution = .3, colour = { .3, .6, .95 }, script = "flock/drop.lua" }
	self:wake(.1)
end
