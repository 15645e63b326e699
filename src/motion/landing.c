#include "motion/flight.h"

#include <float.h>

static const double near = 1e-11; // of the shape's radius: a point that is closer and comes down lands
static const int most_advances = 200; // a grazing corner takes many; after so many it counts as landing

// Euler: dw_i/dt = (I_j - I_k) / I_i w_j w_k, and the squares of the products add up to w^4 / 3 at most.
static double turning_bound(ob_vec3 i, double w)
{
	double k = ob_max(fabs(i.y - i.z) / i.x, ob_max(fabs(i.z - i.x) / i.y, fabs(i.x - i.y) / i.z));
	return w * w * (1 + (i.x > 0 && i.y > 0 && i.z > 0 ? k / sqrt(3) : 0));
}

// A shape is the points around its centre, grown by a radius: a box its corners, a capsule the ends of its axis. A
// cylinder's are the ends of its axis, with a rim about each.
typedef struct outline {
	ob_vec3 half; // m, of the box of the points
	double radius; // m, of each
	double reach; // m, of a point from the centre
	double rim; // m
	const ob_hull *corners; // instead of the box: the points
} outline;

static bool outline_of(const ob_flier *f, outline *h)
{
	*h = (outline){ .half = f->size };
	if (f->shape == OB_SHAPE_SPHERE)
		*h = (outline){ .radius = f->size.x };
	else if (f->shape == OB_SHAPE_CAPSULE)
		*h = (outline){ .half = { 0, 0, f->size.y }, .radius = f->size.x };
	else if (f->shape == OB_SHAPE_CYLINDER)
		*h = (outline){ .half = { 0, 0, f->size.y }, .rim = f->size.x };
	else if (f->shape == OB_SHAPE_HULL)
		*h = (outline){ .corners = f->hull };
	else if (f->shape != OB_SHAPE_BOX)
		return false;
	h->reach = h->corners ? h->corners->radius : ob_norm(ob_v3(h->half.x + h->rim, h->half.y, h->half.z));
	return true;
}

static ob_vec3 component(ob_vec3 half, ob_vec3 n)
{
	return ob_v3(half.x * n.x, half.y * n.y, half.z * n.z);
}

// When a point lands that is this high and rises at this rate, if it falls with the acceleration "most" (s).
static double fall_time(double gap, double rate, double most)
{
	double root = sqrt(rate * rate + 2 * most * gap);
	return rate < 0 ? 2 * gap / (root - rate) : most > 0 ? (rate + root) / most : INFINITY;
}

// A rim: its centre's height and rate of rising; what of the normal is across its axis, and how fast that changes,
// times its radius (m, m/s). Its lowest point is as far below the centre as the first is long.
typedef struct rim {
	double height, rate, most;
	ob_vec3 lean, lean_rate;
} rim;

static double lowest_of_rim(const rim *x, double t)
{
	return x->height + t * (x->rate - .5 * t * x->most) - ob_norm(ob_madd(x->lean, t, x->lean_rate));
}

// For how long no point of the rim lands, at least (s). Its lowest point's height is bounded by a concave function of
// time: between two times below it, so that the chord's zero is early and the tangent's zero is late.
static double rim_time(rim *x, double tolerance)
{
	enum { NARROW = 12 };
	const double lean = ob_norm(x->lean), turn = ob_norm(x->lean_rate);
	double gap = x->height - lean;
	if (gap <= tolerance) {
		bool all = gap + 2 * lean <= tolerance; // the whole rim is on the plane
		if (x->rate - (all ? turn : ob_dot(x->lean, x->lean_rate) / ob_max(lean, DBL_MIN)) < 0)
			return 0;
		x->height = lean, gap = 0;
	}
	double low = fall_time(gap, x->rate - turn, x->most), high = fall_time(gap, x->rate + turn, x->most);
	if (!isfinite(high))
		return low;
	double at_low = lowest_of_rim(x, low), at_high = lowest_of_rim(x, high);
	for (int i = 0; i < NARROW && at_low > 0 && at_high < 0 && at_low > .01 * gap; i++) {
		low += (high - low) * (at_low / (at_low - at_high));
		at_low = lowest_of_rim(x, low);
		ob_vec3 down = ob_madd(x->lean, high, x->lean_rate);
		double slope = x->rate - high * x->most - ob_dot(down, x->lean_rate) / ob_max(ob_norm(down), DBL_MIN);
		if (slope < 0)
			high = ob_max(low, high - at_high / slope), at_high = lowest_of_rim(x, high);
	}
	return low;
}

// When a point lands at least (s), that is so high and rises at this rate; *lands: it does so now.
static void land_point(double gap, double rate, double most, double tolerance, double *least, bool *lands)
{
	const bool touches = gap <= tolerance;
	const double t = fall_time(touches && (rate >= 0 || gap < 0) ? 0 : gap, rate, most);
	if (t < *least)
		*least = t, *lands = touches && rate < 0;
}

// The same of a box's corners, when the first one does: side by side, for which of them rise and which come down nobody
// can foretell. One that rises and never falls has a quotient by zero, which is no less than anything.
static double land_corners(const double *gap, const double *rate, double most, double tolerance, bool *lands)
{
	enum { CORNERS = 8 };
	double t[CORNERS], least = INFINITY;
	for (int k = 0; k < CORNERS; k++) {
		const bool falls = rate[k] < 0;
		const double left = (gap[k] <= tolerance) & (!falls | (gap[k] < 0)) ? 0 : gap[k];
		const double root = sqrt(rate[k] * rate[k] + 2 * most * left);
		t[k] = (falls ? 2 * left : rate[k] + root) / (falls ? root - rate[k] : most);
	}
	for (int k = 0; k < CORNERS; k++)
		if (t[k] < least)
			least = t[k], *lands = gap[k] <= tolerance && rate[k] < 0;
	return least;
}

// For how long no point of the outline lands, at least (s); *lands: one does then. height and speed: of the centre over
// the plane. No point falls faster than with the acceleration "most".
static double advance(const ob_flier *f, const outline *h, ob_vec3 n, double s, double height, double speed,
		      double most, double tolerance, bool *lands)
{
	ob_quat q = f->q;
	ob_vec3 w = { 0, 0, 0 };
	if (f->spin)
		ob_spin_at(f->spin, s, &q, &w);
	ob_mat3 r = ob_quat_matrix(q);
	ob_vec3 normal = ob_rotate_back(&r, n), turning = ob_rotate_back(&r, ob_cross(n, w));
	ob_vec3 up = component(h->half, normal), rise = component(h->half, turning);
	double least = INFINITY;
	if (h->rim > 0) {
		for (int side = -1; side < 2; side += 2) {
			rim x = { height + side * up.z, speed + side * rise.z, most, { 0, 0, 0 }, { 0, 0, 0 } };
			x.lean = ob_scale(ob_v3(normal.x, normal.y, 0), h->rim);
			x.lean_rate = ob_scale(ob_v3(turning.x, turning.y, 0), h->rim);
			least = ob_min(least, rim_time(&x, tolerance));
		}
		*lands = least == 0;
		return least;
	}
	for (uint32_t k = 0; h->corners && k < h->corners->corners; k++) {
		const ob_vec3 c = h->corners->corner[k];
		land_point(height + ob_dot(c, normal), speed + ob_dot(c, turning), most, tolerance, &least, lands);
	}
	if (h->corners)
		return least;
	double gap[8], rate[8];
	for (int k = 0; k < 8; k++) {
		double x = k & 1 ? 1 : -1, y = k & 2 ? 1 : -1, z = k & 4 ? 1 : -1;
		gap[k] = height + x * up.x + y * up.y + z * up.z;
		rate[k] = speed + x * rise.x + y * rise.y + z * rise.z;
	}
	return land_corners(gap, rate, most, tolerance, lands);
}

double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until)
{
	const ob_vec3 n = plane->normal;
	outline h;
	bool known = outline_of(f, &h);
	const double radius = known ? ob_shape_radius(f->shape, f->size) : f->size.x;
	const double p = ob_dot(n, f->p) - plane->offset, v = ob_dot(n, f->v), a = ob_dot(n, f->a);
	if (known && h.reach == 0) {
		double first = ob_time_of_closing(p - radius, v, a, until);
		if (first >= from)
			return first;
	}
	double s = from, height = p + s * (v + .5 * s * a), speed = v + s * a;
	if (height > radius)
		s += ob_time_of_closing(height - radius, speed, a, until - s);
	if (!(s <= until) || !known)
		return s <= until ? s : INFINITY;
	double spin = f->spin ? f->spin->fastest : 0;
	double most = ob_max(0, -a) + h.reach * turning_bound(f->inertia, spin);
	double tolerance = near * radius + 8 * DBL_EPSILON * (ob_norm(f->p) + fabs(plane->offset));
	for (int k = 0; k < most_advances && s <= until; k++) {
		height = p + s * (v + .5 * s * a) - h.radius, speed = v + s * a;
		bool lands = false;
		double t = advance(f, &h, n, s, height, speed, most, tolerance, &lands);
		if (lands)
			return k == 0 ? s : s + t;
		s += ob_max(t, DBL_EPSILON * fabs(s));
	}
	return s <= until ? s : INFINITY;
}
