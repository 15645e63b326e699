-- Goods are collected half a minute after they came.
function on_start()
	self:wake(30)
end

function on_wake()
	self:remove()
end
