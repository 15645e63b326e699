-- expect: :3: sphere.radius: expected a number from 1e-06 to 1000000
local function add(r)
  sphere { radius = r }
end
add(1)
add(-1)
