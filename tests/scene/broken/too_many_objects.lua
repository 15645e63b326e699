-- expect: :5: sphere: expected at most 1000000 objects in a scene
local x = 0
for i = 0, 1000000 do
	for k = 1, 30 do x = x + k end -- each object brings the instructions that it takes
	sphere { radius = .1, at = { i, 0, 0 } }
end
