-- Sends a red crate and a blue barrel onto the belt by turns.
function on_start()
	self.state.sent = 0
	self:wake(0)
end

function on_wake()
	local sent = self.state.sent
	local at = { self.state.x, random(-.1, .1), self.state.z }
	if sent % 2 == 0 then
		box { name = "crate " .. sent, size = { .36, .36, .3 }, at = at, density = 250, friction = .6, colour = "#c9503c", script = "warehouse/goods.lua" }
	else
		box { name = "parcel " .. sent, size = { .3, .4, .26 }, at = at, density = 250, friction = .6, colour = "#2f6db3", script = "warehouse/goods.lua" }
	end
	self.state.sent = sent + 1
	self:wake(self.state.every)
end
