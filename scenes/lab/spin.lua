-- Free rotation of a body with three different moments, about its middle axis, the unstable one.
case {
	row = 20, compared = true, others = "ODE loses 21 % of its energy; MuJoCo with Runge-Kutta 4 2e-7 in 60 s",
	setup = "A body with moments of inertia 1 : 2 : 3 spins at (.05, 5, .02) rad/s, turning over again and again; 300 s.",
}
scene { title = "Torque-free spin", duration = 300, gravity = { 0, 0, 0 } }
-- A flat box, as a body with such moments has no thickness.
local spinner = box { size = { 2, 2 * math.sqrt(.5), .02 }, mass = 6, inertia = { 1, 2, 3 }, spin = { .05, 5, .02 } }

-- ---- numbers of twice the digits, as two (Dekker 1971): after 300 s of turning, single ones have 12 digits of the angle

local function joined(high, low)
	local sum = high + low
	return { sum, low - (sum - high) }
end
local function plus(a, b)
	local sum = a[1] + b[1]
	local of = sum - a[1]
	return joined(sum, a[1] - (sum - of) + (b[1] - of) + a[2] + b[2])
end
local function split(x)
	local large = 134217729 * x
	local high = large - (large - x)
	return high, x - high
end
local function times(a, b)
	local p, x, y, u, v = a[1] * b[1], nil, nil, nil, nil
	x, y = split(a[1])
	u, v = split(b[1])
	return joined(p, x * u - p + x * v + y * u + y * v + a[1] * b[2] + a[2] * b[1])
end
local function number(x) return { x, 0 } end
local function minus(a, b) return plus(a, { -b[1], -b[2] }) end
local function over(a, b)
	local q = a[1] / b[1]
	return joined(q, minus(a, times(number(q), b))[1] / b[1])
end
local function root(a)
	local r = math.sqrt(a[1])
	return joined(r, minus(a, times(number(r), number(r)))[1] / (2 * r))
end
local half, pi = number(.5), { math.pi, 1.2246467991473532e-16 }

-- Complete elliptic integral of (a cos^2 + b sin^2) / ((cos^2 + p sin^2) sqrt(cos^2 + kc^2 sin^2)) (Bulirsch 1969), p > 0.
local function complete(kc, p, a, b)
	local e, m, g = kc, number(1), nil
	p = root(p)
	b = over(b, p)
	for _ = 1, 12 do
		local f = a
		a, g = plus(a, over(b, p)), over(e, p)
		b = plus(b, times(f, g))
		b, p = plus(b, b), plus(g, p)
		g, m = m, plus(kc, m)
		kc = root(e)
		kc = plus(kc, kc)
		e = times(kc, m)
	end
	return times(times(pi, half), over(plus(b, times(a, m)), times(m, plus(m, p))))
end

-- Carlson's symmetric integral of the first kind, by duplication (1979).
local function carlson(x, y, z)
	for _ = 1, 40 do
		local a, b, c = root(x), root(y), root(z)
		local sum = plus(plus(times(a, b), times(a, c)), times(b, c))
		local function next_of(v) return times(number(.25), plus(v, sum)) end
		x, y, z = next_of(x), next_of(y), next_of(z)
	end
	return over(number(1), root(x))
end

-- ---- the motion from a start: Jacobi's elliptic functions (Landau and Lifshitz 1976, Mechanics, section 37)

-- Axes sorted so that the momentum circles the third: z, -y, x. Then w1 = A1 cn(u), w2 = A2 sn(u), w3 = A3 dn(u), u = phase +
-- speed t. The attitude is the turn by chi about the momentum, after the smallest turn from the momentum's direction n to the third
-- axis. With Euler's angles chi = phi + psi, so chi' = w3 + (I1 w1^2 + I2 w2^2) / (L (1 + n3)), even, of period 2 K.
local function follow(b)
	local moment = { b.inertia.z, b.inertia.y, b.inertia.x }
	local i, w = { number(moment[1]), number(moment[2]), number(moment[3]) }, { number(b.spin.z), number(-b.spin.y), number(b.spin.x) }
	local of_z, of_y, of_x = times(i[1], times(w[1], w[1])), times(i[2], times(w[2], w[2])), times(i[3], times(w[3], w[3]))
	local d31, d32, d21 = minus(i[3], i[1]), minus(i[3], i[2]), minus(i[2], i[1])
	local low = plus(times(d31, of_z), times(d32, of_y)) -- 2 E I3 - L^2
	local high = plus(times(d21, of_y), times(d31, of_x)) -- L^2 - 2 E I1
	local beyond = minus(times(d32, of_x), times(d21, of_z)) -- L^2 - 2 E I2
	local square = { over(low, times(i[1], d31)), over(low, times(i[2], d32)), over(high, times(i[3], d31)) } -- of the amplitudes
	local kc2 = over(times(d31, beyond), times(d32, high))
	local kc, speed = root(kc2), root(over(times(d32, high), times(i[1], times(i[2], i[3]))))
	local cn2, sn = over(times(w[1], w[1]), square[1]), over(w[2], root(square[2]))
	local dn2 = plus(kc2, times(minus(number(1), kc2), cn2))
	local phase = times(minus(number(0), sn), carlson(cn2, dn2, number(1)))
	local momentum = root(plus(plus(times(i[1], of_z), times(i[2], of_y)), times(i[3], of_x)))
	local quarter = complete(kc, number(1), number(1), number(1))
	local first, second = times(i[1], square[1]), times(i[2], square[2])
	local precession = over(times(momentum, complete(kc, over(times(i[2], second), times(i[1], first)), first, second)),
		times(quarter, times(i[1], first)))
	local turn = plus(precession, over(times(speed, pi), plus(quarter, quarter))) -- mean of chi'

	local a, c, means, other = { [0] = 1 }, { [0] = math.sqrt(1 - kc2[1]) }, 0, kc[1]
	while c[means] > 1e-10 * a[means] do
		local from = a[means]
		means = means + 1
		a[means], c[means], other = .5 * (from + other), .5 * (from - other), math.sqrt(from * other)
	end
	local amplitude = { math.sqrt(square[1][1]), -math.sqrt(square[2][1]), math.sqrt(square[3][1]) }
	local function rates(u)
		local angle = 2 ^ means * a[means] * u
		for n = means, 1, -1 do angle = .5 * (angle + math.asin(c[n] / a[n] * math.sin(angle))) end
		local cn = math.cos(angle)
		return amplitude[1] * cn, amplitude[2] * math.sin(angle), amplitude[3] * math.sqrt(kc2[1] + (1 - kc2[1]) * cn * cn)
	end
	-- The trapezoid rule gives chi's Fourier series to the last digit (Trefethen and Weideman 2014).
	local points, sample, cosine, wave = 256, {}, {}, {}
	for k = 0, 2 * points - 1 do cosine[k] = math.cos(math.pi * k / points) end
	for k = 0, points do
		local x, y, z = rates(quarter[1] * k / points)
		sample[k] = z + (moment[1] * x * x + moment[2] * y * y) / (momentum[1] + moment[3] * z)
	end
	for k = 1, points // 2 do
		local sum = .5 * (sample[0] + (k % 2 > 0 and -1 or 1) * sample[points])
		for j = 1, points - 1 do sum = sum + sample[j] * cosine[j * k % (2 * points)] end
		wave[k] = 2 * sum / points * quarter[1] / (k * math.pi * speed[1])
	end
	-- Sum of the series, by Clenshaw's recurrence (1955).
	local function waves(u)
		local angle, next, last = math.pi * u / quarter[1], 0, 0
		local double = 2 * math.cos(angle)
		for k = points // 2, 1, -1 do next, last = wave[k] + double * next - last, next end
		return next * math.sin(angle)
	end
	-- Remainder by a period.
	local function within(x, period)
		return minus(x, times(number(math.floor(x[1] / period[1] + .5)), period))[1]
	end
	local period, circle = times(number(4), quarter), times(number(2), pi)
	local function lift(u) -- in the body's axes
		local x, y, z = rates(u)
		local n = 1 / momentum[1] * vector(moment[3] * z, -moment[2] * y, moment[1] * x)
		return rotation(1 + n.x, 0, n.z, -n.y)
	end
	local u0 = within(phase, period)
	local raised = lift(u0)
	local frame, before = b.turn * rotation(raised.w, -raised.x, -raised.y, -raised.z), waves(u0)
	return function(time)
		local u = within(plus(phase, times(speed, number(time))), period)
		local chi = within(times(turn, number(time)), circle) + waves(u) - before
		return frame * rotation(math.cos(.5 * chi), math.sin(.5 * chi), 0, 0) * lift(u)
	end
end

-- Angle of the turn from one attitude to the other, to full precision for small ones.
local function between(a, b)
	local d = b * rotation(a.w, -a.x, -a.y, -a.z)
	return 2 * math.atan(vector(d.x, d.y, d.z):norm(), math.abs(d.w))
end

local energy, momentum, exact
watch(function(run)
	energy, momentum, exact = energy or run.energy, momentum or run.angular_momentum, exact or follow(run[spinner].start)
end)
expect { "error of energy", below = 1e-9, source = "energy at the start", worst = true,
	function(run) return math.abs(run.energy / energy - 1) end }
expect { "error of angular momentum", below = 1e-12, source = "momentum at the start, as a vector", worst = true,
	function(run) return (run.angular_momentum - momentum):norm() / momentum:norm() end }
local off = lab.worst(function(run) return between(exact(run.time), run[spinner].turn) end)
expect { "error of attitude", below = 1e-8, unit = "rad", source = "Jacobi's elliptic functions (Landau and Lifshitz 1976)",
	function(run)
		if between(run[spinner].start.turn, run[spinner].turn) == 0 then run:fail("nothing moved") end
		return off()
	end }
