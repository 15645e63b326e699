-- Thin plates and discs that slide and spin at once. Each element of the surface has friction of its own: sliding slows the spinning,
-- spinning slows the sliding, and both end together.
local this = case { row = 27, variants = {
	{
		name = "plates-plane", title = "Plates slide and spin on a plane",
		setup = "Thin plates, a square, one of 1 : 2 and a bar of 1 : 10, slide and spin until they stop: v over that of the rim from .05 to "
			.. "20; friction .25.",
	}, {
		name = "plates-box", title = "Plates slide and spin on a box", on_box = true,
		setup = "As before, on the upper face of a fixed box.",
	}, {
		name = "discs-plane", title = "Discs slide and spin on a plane", discs = true,
		setup = "Thin cylinders slide and spin until they stop: v over that of the rim from .05 to 20; friction .25.",
	}, {
		name = "discs-box", title = "Discs slide and spin on a box", discs = true, on_box = true,
		setup = "As before, on the upper face of a fixed box.",
	},
} }
local duration = 2
scene { title = this.title, duration = duration }
local g, mu, speed, thin, attitude, heading, radius = 9.81, .25, 2, 1e-3, .3, 1.1, .4 -- speed: m/s, both together; thin: m, half
local ratios = { .05, .2, .5, 1, 2, 5, 20 } -- speed over the rim's
local kinds = this.discs and { { name = "", x = radius, y = thin } } or {
	{ name = ", square", x = .4, y = .4 }, { name = ", 1 : 2", x = .4, y = .2 }, { name = ", bar", x = .5, y = .05 },
}
local function hypot(x, y) return vector(x, y, 0):aside() end

if this.on_box then box { size = { 40, 40, 1 }, at = { 0, 0, -.5 }, friction = mu, static = true } else ground { friction = mu } end
for k, kind in ipairs(kinds) do
	kind.rim = this.discs and radius or hypot(kind.x, kind.y)
	for i, ratio in ipairs(ratios) do
		local v, rim = speed * ratio / hypot(1, ratio), speed / hypot(1, ratio)
		local b = { mass = 1, at = { 4 * (i - 1 - 3), 4 * (k - 2), thin }, friction = mu, q = rotation(vector(0, 0, attitude)),
			velocity = { v * math.cos(heading), v * math.sin(heading), 0 }, spin = { 0, 0, (i % 2 == 0 and -rim or rim) / kind.rim } }
		if this.discs then b.radius, b.length = radius, 2 * thin else b.size = { 2 * kind.x, 2 * kind.y, 2 * thin } end
		kind[i] = (this.discs and cylinder or box)(b)
	end
end

-- ---- means over the surface: direction u / |u| from the instantaneous centre, and distance |u|

local function asinh(x) return x < 0 and -asinh(-x) or math.log(x + math.sqrt(x * x + 1)) end

-- A rectangle, by primitives of x / r, and of r, in both coordinates; the centre lies at cx, cy.
local function rectangle_means(p, cx, cy)
	local function direction(x, y)
		local r = hypot(x, y)
		return x == 0 and .5 * y * r or .5 * (y * r + x * x * asinh(y / math.abs(x)))
	end
	local function distance(x, y)
		local sum = 2 * x * y * hypot(x, y)
		if x ~= 0 then sum = sum + x * x * x * asinh(y / math.abs(x)) end
		if y ~= 0 then sum = sum + y * y * y * asinh(x / math.abs(y)) end
		return sum / 6
	end
	local mx, my, md, area = 0, 0, 0, 4 * p.x * p.y
	for i = -1, 1, 2 do
		for j = -1, 1, 2 do
			local x, y = i * p.x - cx, j * p.y - cy
			mx, my = mx + i * j * direction(x, y) / area, my + i * j * direction(y, x) / area
			md = md + i * j * distance(x, y) / area
		end
	end
	return mx, my, md
end

-- Far from the instantaneous centre the closed form cancels, and the integrand is smooth.
local function rectangle_from_afar(p, vx, vy, w)
	local x, y, turn = 0, 0, 0
	for i = 1, 8 do
		for j = 1, 8 do
			local rx, ry = p.x * lab.gauss.node[i], p.y * lab.gauss.node[j]
			local sx, sy = vx - w * ry, vy + w * rx
			local weight = .25 * lab.gauss.weight[i] * lab.gauss.weight[j] / hypot(sx, sy)
			x, y, turn = x + weight * sx, y + weight * sy, turn + weight * (rx * sy - ry * sx)
		end
	end
	return x, y, turn
end

-- A disc, by complete elliptic integrals, from the arithmetic-geometric mean (Abramowitz and Stegun 1964, 17.6). The
-- instantaneous centre lies at distance d from the disc's along -x.
local function disc_means(d)
	local k2 = math.min(d / radius, radius / d) ^ 2
	local a, b = 1, math.max(1 - k2, 1e-30) ^ .5
	local c, power, sum = .5 * k2 / (1 + b), 1, 0 -- E = K (1 - k2 / 2 - sum)
	while c > 1e-17 do
		a, b, sum, power = .5 * (a + b), (a * b) ^ .5, sum + power * c * c, 2 * power
		c = .5 * c * c / (a + b)
	end
	local first = .5 * math.pi / a -- K
	local along = first * (1.5 * k2 - .5 * k2 * k2 - (1 + k2) * sum) -- (1 + k2) E - (1 - k2) K
	if d < radius then
		return d > 0 and 4 / (3 * math.pi) * along * radius / d or 0,
			4 * radius / (9 * math.pi) * first * (3 + 1.5 * k2 - .5 * k2 * k2 - (7 + k2) * sum)
	end
	return 4 / (3 * math.pi) * along / k2, 4 * d / (9 * math.pi) * (3 * along / k2 + first * (k2 + (2 - 4 * k2) * sum / k2))
end

-- Accelerations of friction in the body's axes: of the centre, and of the turn.
local function friction(p, vx, vy, w)
	local size, along = p.rim, hypot(vx, vy)
	local x, y, torque, inertia = 0, 0, 0, this.discs and .5 * size * size or size * size / 3
	if this.discs and along > 1e6 * size * math.abs(w) then
		if along > 0 then x, y = vx / along, vy / along end
	elseif not this.discs and along > 4 * size * math.abs(w) then
		x, y, torque = rectangle_from_afar(p, vx, vy, w)
	elseif w ~= 0 then
		local cx, cy, sign, mx, my, md = -vy / w, vx / w, w > 0 and 1 or -1, nil, nil, nil
		if this.discs then -- from the centre of rotation towards the disc's centre
			local d, m = hypot(cx, cy), nil
			m, md = disc_means(d)
			mx, my = d > 0 and -m * cx / d or 0, d > 0 and -m * cy / d or 0
		else
			mx, my, md = rectangle_means(p, cx, cy)
		end
		x, y, torque = -sign * my, sign * mx, sign * (md + cx * mx + cy * my)
	end
	return -mu * g * x, -mu * g * y, -mu * g * torque / inertia
end

-- Way and turn of a plate at the end.
local function slide(p, start)
	local v, w = start.velocity, start.spin.z
	local stopped = 1e-5 * (hypot(v.x, v.y) + math.abs(w) * hypot(p.x, p.y))
	local y = lab.integrate(function(y)
		local c, s = math.cos(y[3]), math.sin(y[3])
		local ax, ay, turn = friction(p, c * y[4] + s * y[5], c * y[5] - s * y[4], y[6])
		return { y[4], y[5], y[6], c * ax - s * ay, c * ay + s * ax, turn }
	end, { 0, 0, attitude, v.x, v.y, w }, duration, 1e-9, function(y)
		return hypot(y[4], y[5]) + math.abs(y[6]) * hypot(p.x, p.y) < stopped
	end)
	return y[1], y[2], y[3] - attitude
end

-- Takes long: a plate is computed in a step.
local todo, exact = {}, {}
for _, kind in ipairs(kinds) do
	for _, name in ipairs(kind) do todo[#todo + 1] = { kind, name } end
end
watch(function(run)
	local one = table.remove(todo, 1)
	if one then exact[one[2]] = { slide(one[1], run[one[2]].start) } end
end)

local function remainder(x, y) return x - y * math.floor(x / y + .5) end
for _, kind in ipairs(kinds) do
	local function worst_of(run, f)
		local worst = 0
		for _, name in ipairs(kind) do worst = math.max(worst, f(run[name], table.unpack(exact[name]))) end
		return worst
	end
	local source = "friction of each element of the surface (" .. (this.discs and "Farkas et al. 2003)" or "Goyal, Ruina and Papadopoulos 1991)")
	expect { "error of the way" .. kind.name, below = .01, source = source, function(run)
		if this.on_box or not lab.fell(run) then lab.moved(run, .1) end
		return worst_of(run, function(b, x, y) return hypot(b.moved.x - x, b.moved.y - y) / hypot(x, y) end)
	end }
	expect { "error of the turn" .. kind.name, below = .01, source = source, function(run)
		return worst_of(run, function(b, _, _, turn)
			local from, to = b.start.turn, b.turn
			local turned = 2 * remainder(math.atan(to.z, to.w) - math.atan(from.z, from.w), math.pi)
			return math.abs(remainder(turned - turn, 2 * math.pi) / turn)
		end)
	end }
end
