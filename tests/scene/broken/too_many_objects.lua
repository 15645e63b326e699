-- expect: :5: sphere: expected at most 1000000 objects in a scene
local x, one = 0, { radius = .1 }
for i = 0, 1000000 do
	for k = 1, 17 do x = x + k end -- each object brings the instructions that it takes
	sphere(one)
end
