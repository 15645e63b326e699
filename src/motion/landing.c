#include "motion/flight.h"

#include <float.h>
#include <stdint.h>

static const double near = 1e-11; // of the shape's radius: a point that is closer and comes down lands
static const int most_advances = 200; // a grazing corner takes many; after so many it counts as landing

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

// Two points side by side.
typedef double pair __attribute__((vector_size(16)));
typedef int64_t pair_mask __attribute__((vector_size(16)));

enum { BLOCK = 4, PAIRS_MAX = OB_HULL_CORNERS_MAX / 2 }; // pairs that are worked on together

// Points of the outline: how high (m), how fast they rise (m/s), and how that changes now (m/s^2).
typedef struct points {
	int pairs; // a multiple of BLOCK
	pair gap[PAIRS_MAX], rate[PAIRS_MAX], bend[PAIRS_MAX];
} points;

static pair both(double x)
{
	return (pair){ x, x };
}

static pair where(pair_mask m, pair x)
{
	return (pair)(m & (pair_mask)x);
}

static pair least_of(pair a, pair b)
{
	const pair_mask m = a < b;
	return (pair)((m & (pair_mask)a) | (~m & (pair_mask)b));
}

static int least_index(const pair *of, int pairs)
{
	int index = 0;
	double least = of[0][0];
	for (int k = 0; k < pairs; k++)
		for (int i = 0; i < 2; i++)
			if (of[k][i] < least)
				least = of[k][i], index = 2 * k + i;
	return index;
}

// m: how high each point is at t if it falls with an acceleration of its own. false: none is below the plane.
static bool heights_at(const points *x, const pair *fall, double t, pair *height)
{
	pair_mask below = { 0, 0 };
	for (int k = 0; k < x->pairs; k += BLOCK)
		for (int i = k; i < k + BLOCK; i++) {
			height[i] = x->gap[i] + t * (x->rate[i] - .5 * t * fall[i]);
			below |= (pair_mask)height[i];
		}
	return (below[0] | below[1]) < 0; // the sign
}

// Which of them is the first on the plane within *t (s); -1: none. From the end back: who is below the plane then was
// on it before.
static int first_to_land(const points *x, const pair *fall, double *t)
{
	pair height[PAIRS_MAX];
	int first = -1;
	while (heights_at(x, fall, *t, height)) {
		const int deepest = least_index(height, x->pairs);
		const double when = fall_time(x->gap[deepest / 2][deepest & 1], x->rate[deepest / 2][deepest & 1],
					      fall[deepest / 2][deepest & 1]);
		if (first >= 0 && !(when < *t))
			break;
		first = deepest;
		*t = ob_min(*t, when);
	}
	return first;
}

// When the lowest point lands if it bends as it does now, and some more; or what is left.
static double guess_landing(const points *x, double left)
{
	static const double more = 1.1;
	const int lowest = least_index(x->gap, x->pairs);
	const double bend = x->bend[lowest / 2][lowest & 1];
	return ob_min(left, more * fall_time(x->gap[lowest / 2][lowest & 1], x->rate[lowest / 2][lowest & 1],
					     ob_max(0, -bend)));
}

// For how long no point lands, at least (s); *lands: one does then, to the tolerance. A point falls with the
// acceleration "most" at most, and within t with what it has now and jerk t more: no lower than the parabola with a
// third of that. The better t is guessed, the farther they reach.
static double land_points(points *x, double most, double jerk, double tolerance, double left, bool *lands)
{
	pair fall[PAIRS_MAX];
	pair_mask landed = { 0, 0 };
	for (int k = 0; k < x->pairs; k += BLOCK)
		for (int i = k; i < k + BLOCK; i++) {
			const pair_mask touches = x->gap[i] <= tolerance, falls = x->rate[i] < 0;
			landed |= touches & falls;
			x->gap[i] = where(~(touches & (~falls | (x->gap[i] < 0))), x->gap[i]);
		}
	if ((*lands = landed[0] | landed[1]))
		return 0;
	const double until = guess_landing(x, left), more = jerk * until / 3;
	for (int k = 0; k < x->pairs; k += BLOCK)
		for (int i = k; i < k + BLOCK; i++) {
			const pair down = more - x->bend[i];
			fall[i] = least_of(both(most), where(down > 0, down));
		}
	double t = until;
	const int k = first_to_land(x, fall, &t);
	if (k < 0)
		return until < left ? until : INFINITY;
	const double rate = x->rate[k / 2][k & 1], bend = x->bend[k / 2][k & 1];
	const double above = .5 * t * t * (fall[k / 2][k & 1] + bend + jerk * t / 3);
	*lands = above <= tolerance && rate + t * (bend + .5 * t * jerk) < 0;
	return t;
}

// Of the corners of a box: a value of the centre, and by how much it differs along each half side.
static void box_points(double centre, ob_vec3 by, pair out[BLOCK])
{
	const pair x = { -by.x, by.x };
	for (int k = 0; k < BLOCK; k++)
		out[k] = centre + x + ((k & 1 ? by.y : -by.y) + (k & 2 ? by.z : -by.z));
}

// The same of a hull, and by how much it differs along each axis of its frame. What fills the last block never lands.
static void hull_points(const ob_hull *hull, double centre, ob_vec3 by, points *x, pair *out)
{
	const int n = (int)hull->corners;
	for (int k = 0; k < n; k++)
		out[k / 2][k & 1] = centre + ob_dot(hull->corner[k], by);
	x->pairs = (n + 2 * BLOCK - 1) / (2 * BLOCK) * BLOCK;
	for (int k = n; k < 2 * x->pairs; k++)
		out[k / 2][k & 1] = out == x->gap ? INFINITY : 0;
}

// The flight at s: of the centre, height and speed over the plane; "left" s until nobody asks any more.
typedef struct instant {
	double s, height, speed, left;
} instant;

// For how long no point of the outline lands, at least (s); *lands: one does then.
static double advance(const ob_flier *f, const outline *h, const ob_bending *bends, ob_vec3 n, instant now, double a,
		      double tolerance, bool *lands)
{
	const double most = ob_max(0, -a) + h->reach * bends->most, height = now.height - h->radius;
	ob_quat q = f->q;
	ob_vec3 w = { 0, 0, 0 };
	if (f->spin)
		ob_spin_at(f->spin, now.s, &q, &w);
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 b = ob_rotate_back(&r, w), normal = ob_rotate_back(&r, n), turning = ob_cross(normal, b);
	if (h->rim > 0) {
		double least = INFINITY;
		for (int side = -1; side < 2; side += 2) {
			const double end = side * h->half.z;
			rim x = {
				height + end * normal.z, now.speed + end * turning.z, most, { 0, 0, 0 }, { 0, 0, 0 }
			};
			x.lean = ob_scale(ob_v3(normal.x, normal.y, 0), h->rim);
			x.lean_rate = ob_scale(ob_v3(turning.x, turning.y, 0), h->rim);
			least = ob_min(least, rim_time(&x, tolerance));
		}
		*lands = least == 0;
		return least;
	}
	const ob_vec3 c = bends->coupling, gain = ob_v3(c.x * b.y * b.z, c.y * b.z * b.x, c.z * b.x * b.y);
	const ob_vec3 turn = ob_add(ob_cross(normal, gain), ob_cross(turning, b));
	points x;
	if (h->corners) {
		hull_points(h->corners, height, normal, &x, x.gap);
		hull_points(h->corners, now.speed, turning, &x, x.rate);
		hull_points(h->corners, a, turn, &x, x.bend);
	} else {
		box_points(height, component(h->half, normal), x.gap);
		box_points(now.speed, component(h->half, turning), x.rate);
		box_points(a, component(h->half, turn), x.bend);
		x.pairs = BLOCK;
	}
	return land_points(&x, most, h->reach * bends->jerk, tolerance, now.left, lands);
}

double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until)
{
	const ob_vec3 n = plane->normal;
	outline h;
	const bool known = outline_of(f, &h);
	const double radius = known ? ob_shape_radius(f->shape, f->size) : f->size.x;
	const double p = ob_dot(n, f->p) - plane->offset, v = ob_dot(n, f->v), a = ob_dot(n, f->a);
	if (known && h.reach == 0) {
		double first = ob_time_of_closing(p - radius, v, a, until);
		if (first >= from)
			return first;
	}
	const ob_bending bends = ob_bending_of(f->inertia, f->spin ? f->spin->fastest : 0);
	const double tolerance = near * radius + 8 * DBL_EPSILON * (ob_norm(f->p) + fabs(plane->offset));
	double s = from;
	for (int k = 0; k < most_advances && s <= until; k++) {
		double height = p + s * (v + .5 * s * a), speed = v + s * a;
		if (height > radius) { // until then no point can land, and how it turns need not be known
			s += ob_time_of_closing(height - radius, speed, a, until - s);
			height = p + s * (v + .5 * s * a), speed = v + s * a;
		}
		if (!(s <= until) || !known)
			break;
		bool lands = false;
		const instant now = { s, height, speed, until - s };
		const double t = advance(f, &h, &bends, n, now, a, tolerance, &lands);
		if (lands)
			return s + t;
		s += ob_max(t, DBL_EPSILON * fabs(s));
	}
	return s <= until ? s : INFINITY;
}
