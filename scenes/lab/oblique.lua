-- Ten thousand random oblique hits: a sphere on a sphere, on a box, on a capsule, on a plane. All in free space, each pair in a cell of
-- its own.
local this = case {
	row = 30, runs = 4,
	setup = "A spinning sphere hits a sphere, a fixed box, a fixed capsule, a plane, each 2500 times: sizes, masses, velocities, "
		.. "restitution 0 to 1 and friction 0 to 1.2 drawn by lot; in free space.",
}
scene { title = "Ten thousand oblique hits", duration = .2, gravity = { 0, 0, 0 } }
local partners, hits, side, cell = { "spheres", "boxes", "capsules", "planes" }, 2500, 50, 8
local partner = partners[this.run + 1]
local still = vector(0, 0, 0)

local function unit(random)
	local v
	repeat v = random.vector(1) until v:dot(v) <= 1 and v:dot(v) >= .01
	return 1 / v:norm() * v
end

-- A point of the partner's surface and the normal there, in its frame. size: radius, or radius and half length, or half edges.
local function draw_point(random, size)
	if partner == "spheres" then
		local n = unit(random)
		return size.x * n, n
	elseif partner == "boxes" then -- well inside the face +z
		local y = random.within(-.8, .8) * size.y
		return vector(random.within(-.8, .8) * size.x, y, size.z), vector(0, 0, 1)
	elseif partner == "capsules" then -- the side, or a cap
		local n = unit(random)
		local cap, round = random.real() < .5, 1 / n:aside()
		local normal = cap and n or vector(n.x * round, n.y * round, 0)
		local p = size.x * normal
		local z = cap and (n.z < 0 and -size.y or size.y) or .9 * n.z * size.y
		return vector(p.x, p.y, p.z + z), normal
	end
	return still, vector(0, 0, 1)
end

-- a: the sphere; b: its partner. Both before the hit.
local function draw(i)
	local random = lab.splitmix(1000003 * (this.run + 1) + i)
	for _ = 1, 4 do random.whole() end
	local h = { e = random.real(), mu = 1.2 * random.real() }
	h.time = random.within(.03, .18)
	h.size = vector(.3, .3, .3) + random.vector(.2)
	h.place = vector(cell * (i % side - side / 2), cell * (i // side - side / 2), 0)
	h.q = partner == "planes" and rotation(still) or random.rotation()
	local point, normal = draw_point(random, h.size)
	h.normal, h.point = h.q * normal, h.place + h.q * point
	h.a = { mass = random.within(.5, 5), radius = random.within(.05, .5) }
	local v = random.vector(4)
	h.a.v = v + (-v:dot(h.normal) - random.within(.5, 5)) * h.normal
	h.a.w = random.vector(10)
	h.b = { mass = math.huge, radius = h.size.x, v = still, w = still }
	if partner == "spheres" then
		h.b.mass, h.b.v, h.b.w = random.within(.5, 5), random.vector(1), random.vector(10)
		h.a.v = h.a.v + h.b.v
	end
	return h
end

local hit = {}
for i = 1, hits do
	local h = draw(i - 1)
	hit[i] = h
	h.a.name = sphere { radius = h.a.radius, mass = h.a.mass, friction = h.mu * h.mu, restitution = h.e, velocity = h.a.v, spin = h.a.w,
		at = h.point + h.a.radius * h.normal + -h.time * h.a.v }
end
for i = 1, partner == "planes" and 1 or hits do
	local h = hit[i]
	if partner == "spheres" then
		h.b.name = sphere { radius = h.size.x, mass = h.b.mass, friction = 1, velocity = h.b.v, spin = h.b.w, q = h.q,
			at = h.place + -h.time * h.b.v }
	elseif partner == "boxes" then
		box { size = 2 * h.size, at = h.place, q = h.q, friction = 1, static = true }
	elseif partner == "capsules" then
		capsule { radius = h.size.x, length = 2 * h.size.y, at = h.place, q = h.q, friction = 1, static = true }
	else
		plane { q = h.q, friction = 1 }
	end
end

-- Velocities after the hit: restitution along the normal, from b to a; friction across it, at most what stops the slip.
local function collide(h)
	local a, b, n = h.a, h.b, h.normal
	local function surface(s, normal) return s.v + s.w:cross(s.radius * normal) end
	local u = surface(a, -n) - surface(b, n)
	local mass, approach = 1 / (1 / a.mass + 1 / b.mass), -u:dot(n)
	local slip = u + approach * n
	local along, speed = (1 + h.e) * mass * approach, slip:norm()
	local friction = math.min(h.mu * along, mass / 3.5 * speed)
	local impulse = along * n
	if speed > 0 then impulse = impulse + -friction / speed * slip end
	local function push(s, normal, by)
		if s.mass == math.huge then return s.v, s.w end
		local moment = .4 * s.mass * s.radius * s.radius
		return s.v + 1 / s.mass * by, s.w + s.radius / moment * normal:cross(by)
	end
	local v, w = push(a, -n, impulse)
	return v, w, push(b, n, -impulse)
end

-- Errors over the relative speed at the contact point.
local function worst_error(run)
	local worst = 0
	for _, h in ipairs(hit) do
		local a, b, n = h.a, h.b, h.normal
		local apart = a.v - b.v
		local scale = apart:norm() + (a.radius * a.w + b.radius * b.w):cross(n):norm()
		local v, w, bv, bw = collide(h)
		local function error_of(s, to, turn)
			local now = run[s.name]
			return math.max((now.velocity - to):norm(), s.radius * (now.spin - turn):norm()) / scale
		end
		if (run[a.name].velocity - bv):dot(n) < -.5 * -apart:dot(n) then run:fail("passed through") end
		worst = math.max(worst, error_of(a, v, w), b.name and error_of(b, bv, bw) or 0)
	end
	return worst
end
for i, kind in ipairs(partners) do
	expect { "worst error, on " .. kind, below = 1e-9, source = "Newton's restitution, Coulomb's friction (Routh 1905)",
		function(run) return i == this.run + 1 and worst_error(run) or 0 end }
end
