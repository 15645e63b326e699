-- expect: :3: sphere.radius: expected a number above 0
local function add(r)
  sphere { radius = r }
end
add(1)
add(-1)
