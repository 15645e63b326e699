-- A simulator that computes for some milliseconds in each step, and changes nothing.
function on_step()
	for _ = 1, 500000 do end
end
