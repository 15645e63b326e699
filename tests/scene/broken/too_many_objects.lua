-- expect: :3: sphere: expected at most 200000 objects in a scene
for i = 1, 200001 do
  sphere { radius = 1 }
end
