-- Out of balance by one in a thousand, with sleeping enabled: slow bodies are not at rest.
local coulomb = "mu g t^2 / 2 (Coulomb 1785)"
local this = case { row = 36, sleeps = true, variants = {
	{
		name = "unbalanced-pull", title = "Pulled 1 in 1000 above friction", duration = 10, source = ".001 " .. coulomb,
		setup = "Blocks of 500 kg on a plane and on a box, pulled by 1.001 of what friction holds (.5), may sleep, and must not; "
			.. "10 s.",
	}, {
		name = "unbalanced-incline", title = "On a slope 1 in 1000 too steep", duration = 10,
		source = "g (sin - mu cos) t^2 / 2 (Coulomb 1785)",
		setup = "Blocks on a plane and on a box whose slope is 1.001 of the friction (.5), may sleep, and must not; 10 s.",
	}, {
		name = "unbalanced-brick", title = "Brick 1 in 1000 over the edge", duration = 1.4, slow = true,
		setup = "A brick of 1 x .5 x .2 m reaches 1.001 of half its length over a table's edge, may sleep, and must not: its tilt "
			.. "after 1.4 s.",
	},
} }
scene { title = this.title, duration = this.duration }
local mu, more, g = .5, 1e-3, 9.81

if this.name == "unbalanced-brick" then
	local length, height = .5, .1 -- m, half
	box { size = { 4, 2, 1 }, at = { -2, 0, -.5 }, friction = 1, static = true } -- the table: its edge at x = 0
	local brick = box { size = { 2 * length, .5, 2 * height }, at = { more * length, 0, height }, mass = 10, friction = 1 }
	expect { "error of the tilt", below = .01, source = "it turns about the edge (Newton 1687), integrated", function(run)
		local b = run[brick]
		local beyond = more * length
		local inertia = b.inertia.y / b.mass + beyond * beyond + height * height
		local exact = lab.integrate(function(y)
			return { y[2], g * (beyond * math.cos(y[1]) + height * math.sin(y[1])) / inertia }
		end, { 0, 0 }, run.time, 1e-13)[1]
		local up = b.turn:axis "z"
		local error = math.abs(math.atan(up.x, up.z) / exact - 1)
		if error > .99 then run:fail("stands") end
		return error
	end }
else
	local pulled = this.name == "unbalanced-pull"
	local angle = pulled and 0 or math.atan((1 + more) * mu)
	local tilt = rotation(vector(0, angle, 0))
	local down, across, up = tilt:axis "x", tilt:axis "y", tilt:axis "z"
	local block, force = {}, { pulled and (1 + more) * mu * 500 * g or 0, 0, 0 }
	plane { name = "support", q = tilt, friction = mu }
	for i = 0, 1 do
		local on = 10 * i * across + i * up
		if i == 1 then box { size = { 10, 4, 1 }, at = on - .5 * up, q = tilt, friction = mu, static = true } end
		block[i + 1] = box { size = { 1, 1, .5 }, at = on + .25 * up, q = tilt, mass = 500, friction = mu, force = force }
	end
	local acceleration = pulled and more * mu * g or g * (math.sin(angle) - mu * math.cos(angle))
	for i, place in ipairs { "a plane", "a box" } do
		expect { "error of the way, on " .. place, below = .01, source = this.source, function(run)
			local exact = .5 * acceleration * run.time * run.time * down
			lab.moved(run, .1 * exact:norm())
			return (run[block[i]].moved - exact):norm() / exact:norm()
		end }
	end
end
