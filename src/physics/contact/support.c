#include "contact/support.h"

#include "shape/shape.h"

static const double flat = 1e-12; // part of a unit vector across an axis: a smaller one has no direction
static const double converged = 1e-14; // relative to the shapes' size: gradient that counts as 0
static const double rounding = 1e-14; // relative to the shapes' size
static const double flattest = 1e-9; // relative to the shapes' size: least curvature by which a step is scaled
static const double beside_jump = 1e-13; // relative distance (tangent) from a jump at which the slope is that of its
	// side
static const double widest = 1e4; // tangent of the largest turn of a climb

static ob_vec3 unit(ob_vec3 v)
{
	return ob_scale(v, 1 / ob_norm(v));
}

ob_vec3 ob_support(const ob_placed *x, ob_vec3 n)
{
	const ob_vec3 l = ob_rotate_back(&x->r, n);
	return ob_add(x->p, ob_rotate(&x->r, ob_shape_kind_of(x->shape)->farthest(&x->size, x->hull, &l)));
}

ob_vec3 ob_support_between(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	return ob_sub(ob_support(a, ob_scale(n, -1)), ob_support(b, n));
}

double ob_reach(const ob_placed *x, ob_vec3 n)
{
	const ob_vec3 z = ob_column(&x->r, 2);
	const double along = fabs(ob_dot(z, n));
	if (ob_shape_is(x->shape, OB_SIDED))
		return x->size.x * fabs(ob_dot(ob_column(&x->r, 0), n)) +
		       x->size.y * fabs(ob_dot(ob_column(&x->r, 1), n)) + x->size.z * along;
	if (ob_shape_is(x->shape, OB_AXIAL)) {
		const double across = ob_shape_is(x->shape, OB_RIMMED) ? ob_norm(ob_cross(z, n)) : ob_norm(n);
		return x->size.x * across + x->size.y * along;
	}
	return ob_dot(n, ob_sub(ob_support(x, n), x->p));
}

double ob_apart_along(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	return ob_dot(n, ob_sub(a->p, b->p)) - ob_reach(a, ob_scale(n, -1)) - ob_reach(b, n);
}

// ---- across an axis

// Shape as seen along directions p + t q, with perpendicular unit vectors p and q.
typedef struct slice {
	const ob_placed *x;
	double turn; // -1: seen from the other side
	ob_vec3 p, q; // in the shape's frame
	double half[3]; // m: half extents of the box inside the shape, to which round parts are added; 0 for a hull
	double radius; // m, of a cylinder's rim
} slice;

static slice slice_of(const ob_placed *x, double turn, ob_vec3 p, ob_vec3 q)
{
	slice s = { .x = x, .turn = turn, .p = ob_rotate_back(&x->r, p), .q = ob_rotate_back(&x->r, q) };
	ob_outline o;
	ob_shape_outline(x->shape, x->size, &o);
	s.half[0] = o.half.x, s.half[1] = o.half.y, s.half[2] = o.half.z;
	s.radius = o.rim;
	return s;
}

// The shape's part of the slope: its support point, from its centre, along q - t p. A ball adds nothing.
static double part_of_slope(const slice *s, double t)
{
	const ob_vec3 n = ob_madd(s->p, t, s->q), d = ob_madd(s->q, -t, s->p);
	if (s->x->hull) {
		const ob_vec3 at = ob_sub(ob_support(s->x, ob_scale(ob_rotate(&s->x->r, n), s->turn)), s->x->p);
		return s->turn * ob_dot(ob_rotate(&s->x->r, d), at);
	}
	double sum = copysign(s->half[2], n.z) * d.z;
	if (ob_shape_is(s->x->shape, OB_SIDED))
		return sum + copysign(s->half[0], n.x) * d.x + copysign(s->half[1], n.y) * d.y;
	const double across = sqrt(n.x * n.x + n.y * n.y);
	return across > flat ? sum + s->radius * (n.x * d.x + n.y * d.y) / across : sum;
}

// Adds to jump the values of t at which the slope jumps: the support point changes from one end of the shape to the
// other. Returns the number of jumps.
static int add_jumps(const slice *s, double jump[6], int n)
{
	const double p[3] = { s->p.x, s->p.y, s->p.z }, q[3] = { s->q.x, s->q.y, s->q.z };
	for (int i = 0; i < 3; i++)
		if (s->half[i] > 0 && fabs(q[i]) > flat)
			jump[n++] = -p[i] / q[i];
	return n;
}

// Derivative of the separation along p + t q, up to a positive factor. apart: m, of the centres along p and q.
static double slope_at(const slice *a, const slice *b, const double apart[2], double t)
{
	return apart[1] - t * apart[0] - part_of_slope(a, t) - part_of_slope(b, t);
}

ob_vec3 ob_climb_across(const ob_placed *a, const ob_placed *b, ob_vec3 e, ob_vec3 from)
{
	enum { WIDEN = 40, NARROW = 80 };
	ob_vec3 p = ob_madd(from, -ob_dot(from, e), e);
	if (ob_norm2(p) < 1e-8) {
		ob_vec3 d = ob_sub(ob_middle(a), ob_middle(b));
		p = ob_madd(d, -ob_dot(d, e), e);
		if (ob_norm2(p) < 1e-8 * ob_norm2(d) || !(ob_norm2(p) > 0))
			return from;
	}
	p = unit(p);
	const ob_vec3 q = ob_cross(e, p);
	const double size = ob_norm(a->size) + ob_norm(b->size);
	const slice of_a = slice_of(a, -1, p, q), of_b = slice_of(b, 1, p, q);
	const double apart[2] = { ob_dot(p, ob_sub(a->p, b->p)), ob_dot(q, ob_sub(a->p, b->p)) };
	double low = 0, at_low = slope_at(&of_a, &of_b, apart, 0), high = 0, at_high = 0, way = at_low < 0 ? -1 : 1;
	if (fabs(at_low) <= converged * size)
		return p;
	double step = way * ob_min(.1, ob_max(1e-6, fabs(at_low) / size));
	for (int i = 0; i < WIDEN && at_high * at_low >= 0; i++, step *= 4) {
		if (i)
			low = high, at_low = at_high;
		high = low + step;
		if (fabs(high) > widest)
			return unit(ob_madd(p, low, q));
		at_high = slope_at(&of_a, &of_b, apart, high);
		if (at_high == 0)
			return unit(ob_madd(p, high, q));
	}
	// The maximum is often at a jump of the slope; any other jump is excluded from the bracket.
	double jump[6];
	const int jumps = add_jumps(&of_b, jump, add_jumps(&of_a, jump, 0));
	for (int k = 0; k < jumps; k++) {
		const double beside = (high > low ? beside_jump : -beside_jump) * (1 + fabs(jump[k])),
			     before = jump[k] - beside, after = jump[k] + beside;
		if (!((before - low) * beside > 0 && (high - after) * beside > 0))
			continue;
		const double at_before = slope_at(&of_a, &of_b, apart, before);
		if (at_before * at_low <= 0) {
			high = before, at_high = at_before;
			continue;
		}
		const double at_after = slope_at(&of_a, &of_b, apart, after);
		if (at_after * at_low <= 0)
			return unit(ob_madd(p, jump[k], q));
		low = after, at_low = at_after;
	}
	// Illinois form of regula falsi (Dowell and Jarratt 1971): an end that is kept twice counts half.
	double weigh_low = 1, weigh_high = 1;
	int kept = 0; // end that was kept: -1 low, 1 high
	for (int i = 0; i < NARROW && fabs(high - low) > 2e-16 * (1 + fabs(low)); i++) {
		const double share = weigh_low * at_low / (weigh_low * at_low - weigh_high * at_high);
		const double mid = low + (high - low) * (i % 8 == 7 ? .5 : share),
			     at = slope_at(&of_a, &of_b, apart, mid);
		if (fabs(at) <= converged * size * (1 + fabs(mid)))
			return unit(ob_madd(p, mid, q));
		if (at * at_low > 0) {
			weigh_high = kept > 0 ? .5 * weigh_high : 1;
			weigh_low = 1, low = mid, at_low = at, kept = 1;
		} else {
			weigh_low = kept < 0 ? .5 * weigh_low : 1;
			weigh_high = 1, high = mid, at_high = at, kept = -1;
		}
	}
	return unit(ob_madd(p, low, q));
}

// ---- two rims

// Adds the rim's part of the curvature of the separation at n, in the basis p, q across n: xx, xy, yy.
static void add_curvature(const ob_placed *x, ob_vec3 n, ob_vec3 p, ob_vec3 q, double m[3])
{
	ob_vec3 d = ob_column(&x->r, 2), t = ob_cross(d, n);
	double across2 = ob_norm2(t);
	if (!ob_shape_is(x->shape, OB_RIMMED) || across2 < flat)
		return;
	double k = x->size.x / (across2 * sqrt(across2)), tp = ob_dot(t, p), tq = ob_dot(t, q);
	m[0] += k * tp * tp;
	m[1] += k * tp * tq;
	m[2] += k * tq * tq;
}

// Leaves a cap's normal d, where the separation has no derivative: returns a better direction nearby, or n.
static ob_vec3 off_axis(const ob_placed *a, const ob_placed *b, ob_vec3 n, ob_vec3 d)
{
	if (ob_norm2(ob_cross(n, d)) > 1e-16)
		return n;
	ob_vec3 g = ob_support_between(a, b, n);
	double gap = ob_dot(n, g);
	g = ob_madd(g, -gap, n);
	for (double step = .3; step > 1e-7 && ob_norm2(g) > 0; step *= .3) {
		ob_vec3 next = unit(ob_madd(n, step / ob_norm(g), g));
		if (ob_apart_along(a, b, next) > gap)
			return next;
	}
	return n;
}

// Newton's step uphill, in a basis across n, from the slope g and the curvature m (xx, xy, yy; positive on a hill).
// Principal curvatures count by their magnitude, at least "least": along a ridge the surface is nearly flat, and may be
// curved either way.
static void newton_step(const double g[2], const double m[3], double least, double step[2])
{
	const double mean = .5 * (m[0] + m[2]), half = .5 * (m[0] - m[2]), root = sqrt(half * half + m[1] * m[1]);
	double x = m[1], y = root - half; // direction of the larger curvature, mean + root
	if (half > 0)
		x = root + half, y = m[1];
	const double l = sqrt(x * x + y * y);
	x = l > 0 ? x / l : 1, y = l > 0 ? y / l : 0;
	const double along = (g[0] * x + g[1] * y) / ob_max(fabs(mean + root), least),
		     across = (g[1] * x - g[0] * y) / ob_max(fabs(mean - root), least);
	step[0] = along * x - across * y;
	step[1] = along * y + across * x;
}

ob_vec3 ob_climb_rims(const ob_placed *a, const ob_placed *b, ob_vec3 from)
{
	enum { NEWTON = 30, HALVE = 12 };
	const double size = ob_norm(a->size) + ob_norm(b->size), longest = .5;
	ob_vec3 n = off_axis(a, b, off_axis(a, b, from, ob_column(&a->r, 2)), ob_column(&b->r, 2));
	for (int i = 0; i < NEWTON; i++) {
		ob_vec3 g = ob_support_between(a, b, n),
			p = unit(ob_cross(n, fabs(n.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0)));
		ob_vec3 q = ob_cross(n, p);
		const double gap = ob_dot(n, g), slope[2] = { ob_dot(g, p), ob_dot(g, q) };
		double m[3] = { gap, 0, gap }, step[2];
		if (fabs(slope[0]) + fabs(slope[1]) <= converged * size)
			break;
		add_curvature(a, n, p, q, m);
		add_curvature(b, n, p, q, m);
		newton_step(slope, m, flattest * size, step);
		const double l = sqrt(step[0] * step[0] + step[1] * step[1]);
		bool better = false;
		double k = l > longest ? longest / l : 1;
		for (int h = 0; h < HALVE && !better; h++, k *= .5) {
			ob_vec3 next = unit(ob_madd(ob_madd(n, k * step[0], p), k * step[1], q));
			ob_vec3 at_next = ob_support_between(a, b, next);
			double gain = ob_dot(next, at_next) - gap,
			       left = ob_norm2(ob_madd(at_next, -ob_dot(next, at_next), next));
			// near the maximum a gain is lost in rounding, the slope is not
			better = gain > rounding * size ||
				 (gain > -rounding * size && left < slope[0] * slope[0] + slope[1] * slope[1]);
			if (better)
				n = next;
		}
		if (!better)
			break;
	}
	return n;
}
