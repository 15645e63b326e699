// Continuation of a received motion: a parabola, or an ellipse with a frequency, and rotation at constant rate or the
// free rotation of a rigid body. Quaternions are w x y z and rotate from the body's axes to the world's, as in
// <ob/vec.h>.

export const STANDS = 0, TURNS = 1, FREE = 2, SWINGS = 3;
const RADIANS_A_STEP = 0.05; // for Runge and Kutta's method of fourth order: 1e-8 rad in a radian

export const multiply = (a, b) => [
	a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
	a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
	a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
	a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];

export function normalize(q) {
	const s = 1 / Math.hypot(q[0], q[1], q[2], q[3]);
	return [q[0] * s, q[1] * s, q[2] * s, q[3] * s];
}

// v rotated by q; by its inverse with sign -1.
export function turned(q, v, sign = 1) {
	const [w, x, y, z] = [q[0] * sign, q[1], q[2], q[3]];
	const tx = y * v[2] - z * v[1] + w * v[0], ty = z * v[0] - x * v[2] + w * v[1], tz = x * v[1] - y * v[0] + w * v[2];
	return [v[0] + 2 * (y * tz - z * ty), v[1] + 2 * (z * tx - x * tz), v[2] + 2 * (x * ty - y * tx)];
}

// q rotated by the rotation vector w s (world).
function turnedBy(q, w, s) {
	const angle = Math.hypot(w[0], w[1], w[2]) * s;
	const share = Math.abs(angle) > 1e-6 ? Math.sin(angle / 2) / angle * s : s / 2;
	return normalize(multiply([Math.cos(angle / 2), w[0] * share, w[1] * share, w[2] * share], q));
}

function derivative(q, momentum, inertia) {
	const l = turned(q, momentum, -1);
	const w = turned(q, [l[0] / inertia[0], l[1] / inertia[1], l[2] / inertia[2]]);
	return multiply([0, w[0] / 2, w[1] / 2, w[2] / 2], q);
}

const along = (q, h, d) => [q[0] + h * d[0], q[1] + h * d[1], q[2] + h * d[2], q[3] + h * d[3]];

// Euler's equations, with the angular momentum (world) constant.
function rotatedFree(q, momentum, inertia, s) {
	const fastest = Math.hypot(...momentum) / Math.min(...inertia);
	const steps = Math.min(2000, Math.ceil(Math.abs(s) * fastest / RADIANS_A_STEP)), h = s / steps;
	for (let i = 0; i < steps; i++) {
		const a = derivative(q, momentum, inertia), b = derivative(along(q, h / 2, a), momentum, inertia);
		const c = derivative(along(q, h / 2, b), momentum, inertia), d = derivative(along(q, h, c), momentum, inertia);
		q = normalize([0, 1, 2, 3].map((k) => q[k] + h / 6 * (a[k] + 2 * b[k] + 2 * c[k] + d[k])));
	}
	return q;
}

function momentumOf(q, w, inertia) {
	const l = turned(q, w, -1);
	return turned(q, [l[0] * inertia[0], l[1] * inertia[1], l[2] * inertia[2]]);
}

const isEven = (i) => !(i[0] > 0) || (Math.abs(i[0] - i[1]) < 1e-6 * i[0] && Math.abs(i[0] - i[2]) < 1e-6 * i[0]);

function centreAfter(m, s) {
	if (m.kind !== SWINGS)
		return [0, 1, 2].map((k) => m.p[k] + s * (m.v[k] + s / 2 * m.a[k]));
	const f = m.frequency, along = Math.sin(f * s) / f, aside = 2 * (Math.sin(f * s / 2) / f) ** 2;
	return [0, 1, 2].map((k) => m.p[k] + along * m.v[k] + aside * m.a[k]);
}

// Pose of a body at time t (s) by motion m: { p, q }.
export function poseAt(m, inertia, t) {
	const s = t - m.t0;
	if (m.kind === STANDS || s === 0)
		return { p: m.p, q: m.q };
	const p = centreAfter(m, s);
	if (m.kind !== FREE || isEven(inertia))
		return { p, q: turnedBy(m.q, m.w, s) };
	// continues from the last call, if that was earlier
	const from = m.last && s >= 0 && m.last.s <= s ? m.last : { s: 0, q: m.q };
	m.momentum ??= momentumOf(m.q, m.w, inertia);
	m.last = { s, q: rotatedFree(from.q, m.momentum, inertia, s - from.s) };
	return { p, q: m.last.q };
}
