-- expect: hull.points: expected a hull of at most 64 corners, got 65
local p = {}
for i = 1, 65 do
	local z, a = 2 * (i - .5) / 65 - 1, 2.4 * i
	local r = math.sqrt(1 - z * z)
	p[i] = { r * math.cos(a), r * math.sin(a), z }
end
hull { points = p }
