-- A suspension bridge of planks on hinges, and boxes that fall on it. Each plank is a simulator of its own.
local planks = param("planks", 20, { whole = true })
scene { title = "A bridge of planks", duration = 10 }
sky { top = "#7fa8cf", horizon = "#eef0ee" }
sun { towards = { .6, -.8, .8 } }
ground { colour = "#8fae7c" }
material "wood" { friction = .6, density = 600, colour = "#a9744f" }
material "stone" { friction = .7, colour = "#8d8d88" }
camera "main" { eye = { 2.76, -13.79, 9.26 }, target = { 0, 0, 2.4 } }

local wide, high = .4, 2.6
local half = planks * wide / 2
for side = -1, 1, 2 do
	box { name = side < 0 and "west" or "east", material = "stone", size = { 2, 2.4, high }, at = { side * (half + 1), 0, high / 2 }, static = true }
end
-- Planks hang in a curve that is longer than the gap.
local sag = .06 * 2 * half
local function height(k) return high - .05 - sag * (1 - (2 * k / planks - 1) ^ 2) end
local function place(k) return { -half + k * wide, 0, height(k) } end
for k = 1, planks do
	local a, b = place(k - 1), place(k)
	local dx, dz = b[1] - a[1], b[3] - a[3]
	box {
		name = "plank" .. k, material = "wood", size = { math.sqrt(dx * dx + dz * dz) - .02, 1.8, .08 },
		at = { (a[1] + b[1]) / 2, 0, (a[3] + b[3]) / 2 },
		rotation = { axis = { 0, 1, 0 }, degrees = -math.deg(math.atan(dz, dx)) },
	}
	hinge { "plank" .. k, k > 1 and "plank" .. k - 1 or "west", at = a, axis = { 0, 1, 0 } }
end
hinge { "plank" .. planks, "east", at = place(planks), axis = { 0, 1, 0 } }
for i = 1, 6 do
	box { size = { .4, .4, .4 }, at = { (i - 3.5) * .7, random(-.4, .4), high + 1 + .5 * i }, q = random_rotation(), density = 400 }
end
