-- The five regular solids, as convex hulls of their corners, tumble onto the ground and roll out.
scene { title = "The five regular solids", duration = 6 }
material "solid" { density = 900, friction = .5, restitution = .25 }
ground {}
camera "main" { eye = { -5.3, -8.14, 6.45 }, target = { .1, .2, 1.6 }, fov = 48 }

local f = (1 + math.sqrt(5)) / 2 -- the golden ratio

-- {x, y, z} with all signs, and the cyclic changes of its places.
local function with_signs(x, y, z)
	local points = {}
	for i = 0, 7 do
		local p = { i & 1 == 0 and x or -x, i & 2 == 0 and y or -y, i & 4 == 0 and z or -z }
		points[#points + 1] = p
	end
	return points
end

local function cyclic(x, y, z)
	local points = {}
	for _, p in ipairs(with_signs(x, y, z)) do
		points[#points + 1] = p
		points[#points + 1] = { p[2], p[3], p[1] }
		points[#points + 1] = { p[3], p[1], p[2] }
	end
	return points
end

local function join(a, b)
	for _, p in ipairs(b) do
		a[#a + 1] = p
	end
	return a
end

-- All corners at the distance radius from the middle. A point that is there twice is one corner.
local function sized(points, radius)
	for _, p in ipairs(points) do
		local l = radius / math.sqrt(p[1] ^ 2 + p[2] ^ 2 + p[3] ^ 2)
		p[1], p[2], p[3] = p[1] * l, p[2] * l, p[3] * l
	end
	return points
end

local solids = {
	{ "tetrahedron", sized({ { 1, 1, 1 }, { 1, -1, -1 }, { -1, 1, -1 }, { -1, -1, 1 } }, .78), "#e4572e" },
	{ "cube", sized(with_signs(1, 1, 1), .72), "#f3a712" },
	{ "octahedron", sized(cyclic(0, 0, 1), .68), "#29a19c" },
	{ "dodecahedron", sized(join(with_signs(1, 1, 1), cyclic(0, 1 / f, f)), .64), "#3f7cac" },
	{ "icosahedron", sized(cyclic(0, 1, f), .64), "#8d6a9f" },
}

for row = 0, param("rows", 3, { whole = true }) - 1 do
	for i, s in ipairs(solids) do
		local turn = (i + 2 * row) % 5
		hull {
			name = s[1] .. (row > 0 and " " .. row + 1 or ""),
			points = s[2],
			at = { (turn - 2) * 1.35 + .3 * (row % 2), -1.2 + 1.3 * row, 1.6 + .9 * row + .25 * i },
			q = random_rotation(),
			velocity = { random(-.6, .6), random(-.6, .6), random(-1, 1) },
			spin = { random(-4, 4), random(-4, 4), random(-4, 4) },
			material = "solid",
			colour = s[3],
		}
	end
end
