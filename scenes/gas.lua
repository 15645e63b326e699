-- Gas: balls and boxes fly about in a closed box, without gravity, and lose nothing when they hit. All moves for ever.
--   -D n=200         how many
--   -D speed=3       m/s
local n = param("n", 200, { whole = true, min = 2, max = 20000, label = "bodies" })
local speed = param("speed", 3.0, { min = 0, max = 100, unit = "m/s" })

scene { title = "Gas", duration = 10, gravity = { 0, 0, 0 }, sleeping = false }
material "billiard" { friction = 0, restitution = 1, density = 1000 }

local side = math.ceil(n ^ (1 / 3))
local half = .6 * side
for k = 1, 3 do
	for sign = -1, 1, 2 do
		local normal, at = { 0, 0, 0 }, { 0, 0, 0 }
		normal[k], at[k] = -sign, sign * half
		plane { normal = normal, at = at, material = "billiard", colour = k == 3 and "#b4b9b3" or "#c9d3da" }
	end
end
sun { towards = { -.5, -.62, .6 } }
camera "main" { eye = { -2.1 * half, -2.8 * half, 1.7 * half }, target = { 0, 0, -.1 * half }, fov = 50 }

for i = 0, n - 1 do
	local at = {}
	for k, cell in ipairs { i % side, i // side % side, i // (side * side) } do
		at[k] = (cell - (side - 1) / 2) * 1.2 + random(-.1, .1)
	end
	local velocity = { random(-speed, speed), random(-speed, speed), random(-speed, speed) }
	if i % 2 == 0 then
		sphere { radius = random(.1, .25), at = at, velocity = velocity, material = "billiard" }
	else
		box {
			size = { random(.2, .5), random(.2, .5), random(.2, .5) }, at = at, q = random_rotation(), velocity = velocity,
			spin = { random(-3, 3), random(-3, 3), random(-3, 3) }, material = "billiard",
		}
	end
end
