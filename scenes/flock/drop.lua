-- It is there for four seconds, and pales where it touches something.
function on_start()
	self:wake(4)
end

function on_contact(other, impulse, point)
	self:colour { .75, .88, 1 }
end

function on_wake()
	self:remove()
end
