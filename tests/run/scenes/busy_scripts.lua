-- Ten thousand scripts that each compute for long, in each step, and stay below the limit of a single one.
script("busy", [[
function on_step(dt)
	for i = 1, 220000 do local x = i * i end
end
]])
for i = 1, 1e4 do
	sphere { radius = .1, at = { i, 0, 0 }, script = "busy" }
end
