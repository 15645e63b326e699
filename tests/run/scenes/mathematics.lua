-- Places, velocities and forces by every function of mathematics that scenes and scripts can call. A different last bit
-- in one of them changes where the balls are.
local functions = { "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log" }

script("dancer", [[
function on_step(dt)
	local x, y, z = self:position()
	local a = math.sin(3 * x + y) + math.cos(y ^ 2.3 + x) + math.tan(.3 * z)
	local b = math.exp(-z ^ 1.7) + math.log(1 + x * x) + math.log(2 + y * y, 10) + math.log(2 + z, 2)
	local c = math.asin(math.sin(x)) + math.acos(math.cos(y)) + math.atan(x, z) + math.atan(y)
	self:force(self:mass() * a, self:mass() * (b - 2), self:mass() * (c + 9.81))
end
]])
for i, name in ipairs(functions) do
	for k = 1, 10 do
		local u = (k - .5) / 10
		local v = math.abs(math[name](u)) ^ .7
		sphere { radius = .05, at = { i, k, 5 + v }, velocity = { v, 0, 0 }, spin = { v, 1, u },
		         script = k % 2 == 0 and "dancer" or nil }
	end
end
ground {}
