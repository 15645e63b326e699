#include "motion/flight.h"

#include <float.h>
#include <stdint.h>

#include "elementary/lanes.h"
#include "motion/landing_lanes.h"
#include "shape/shape.h"

static const double near = 1e-11; // relative to the shape's radius: a falling point below this height lands
static const int most_advances = 200; // a grazing corner takes many; after so many it counts as landing

// Outline: points around the centre, grown by a radius. A box has its corners, a capsule the ends of its axis. A
// cylinder has the ends of its axis, with a rim about each. Of a hull the points are its corners.
typedef struct outline {
	ob_vec3 half; // m, half extents of the box of the points
	double radius; // m, of each
	double reach; // m, of a point from the centre
	double rim; // m
	const ob_hull *corners; // instead of the box: the points
} outline;

static bool outline_of(const ob_flier *f, outline *h)
{
	ob_outline of;
	const bool summed = ob_shape_outline(f->shape, f->size, &of);
	*h = (outline){ .half = of.half, .radius = of.ball, .rim = of.rim };
	h->corners = ob_shape_is(f->shape, OB_HULLED) ? f->hull : NULL;
	h->reach = h->corners ? h->corners->radius : ob_norm(ob_v3(h->half.x + h->rim, h->half.y, h->half.z));
	return summed || h->corners;
}

static ob_vec3 component(ob_vec3 half, ob_vec3 n)
{
	return ob_v3(half.x * n.x, half.y * n.y, half.z * n.z);
}

// Time (s) to land of a point at this height and rate of rising, if it falls with the acceleration "most".
static double fall_time(double gap, double rate, double most)
{
	double root = sqrt(rate * rate + 2 * most * gap);
	return rate < 0 ? 2 * gap / (root - rate) : most > 0 ? (rate + root) / most : INFINITY;
}

// Rim of a cylinder: height and rate of rising of its centre (m, m/s). `lean`: the part of the normal across its axis,
// times its radius, and the rate of that (m, m/s). The lowest point is |lean| below the centre.
typedef struct rim {
	double height, rate, most;
	ob_vec3 lean, lean_rate;
} rim;

static double lowest_of_rim(const rim *x, double t)
{
	return x->height + t * (x->rate - .5 * t * x->most) - ob_norm(ob_madd(x->lean, t, x->lean_rate));
}

// Lower bound (s) of the time until a point of the rim lands. A concave function of time bounds the lowest point's
// height: between two times below it, so the chord's zero is early and the tangent's zero is late.
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

enum { BLOCK = 4, PAIRS_MAX = OB_HULL_CORNERS_MAX / 2 }; // pairs processed together

// Points of the outline: heights (m), their rates (m/s), and their present accelerations (m/s^2).
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

// Height (m) of each point at t if it falls with an acceleration of its own. Returns false if none is below the plane.
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

// Returns the point that is first on the plane within *t (s); -1: none. Goes backwards: a point below the plane at the
// end was on it before.
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

// Estimates the landing of the lowest point from its present acceleration and a margin; at most the remaining time.
static double guess_landing(const points *x, double left)
{
	static const double more = 1.1;
	const int lowest = least_index(x->gap, x->pairs);
	const double bend = x->bend[lowest / 2][lowest & 1];
	return ob_min(left, more * fall_time(x->gap[lowest / 2][lowest & 1], x->rate[lowest / 2][lowest & 1],
					     ob_max(0, -bend)));
}

// Lower bound (s) of the time until a point lands; *lands: one does then, to the tolerance. A point falls with the
// acceleration "most" at most, and within t with its present one plus jerk t: no lower than the parabola with a third
// of that. A better guess of t makes the bound reach farther.
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

// Values at the corners of a box: value of the centre, and its change along each half side.
static void box_points(double centre, ob_vec3 by, pair out[BLOCK])
{
	const pair x = { -by.x, by.x };
	for (int k = 0; k < BLOCK; k++)
		out[k] = centre + x + ((k & 1 ? by.y : -by.y) + (k & 2 ? by.z : -by.z));
}

// Same for a hull: changes along each axis of its frame. Padding of the last block never lands.
static void hull_points(const ob_hull *hull, double centre, ob_vec3 by, points *x, pair *out)
{
	const int n = (int)hull->corners;
	for (int k = 0; k < n; k++)
		out[k / 2][k & 1] = centre + ob_dot(hull->corner[k], by);
	x->pairs = (n + 2 * BLOCK - 1) / (2 * BLOCK) * BLOCK;
	for (int k = n; k < 2 * x->pairs; k++)
		out[k / 2][k & 1] = out == x->gap ? INFINITY : 0;
}

// Flight at an instant s: height and speed of the centre over the plane; `left`: remaining time (s) of the search.
typedef struct instant {
	double s, height, speed, left;
} instant;

// Search for the landing of a flight.
typedef struct search {
	const ob_flier *f;
	outline h;
	bool known; // its shape is known
	ob_vec3 n;
	ob_bending bends;
	double p, v, a; // the centre, over the plane at s = 0
	double radius, tolerance; // m
	double until;
	int advances;
	instant now;
} search;

// Largest downward acceleration of any point (m/s^2).
static double fastest_fall(const search *x)
{
	return ob_max(0, -x->a) + x->h.reach * x->bends.most;
}

static void attitude_of(const search *x, ob_quat *q, ob_vec3 *w)
{
	*q = x->f->q;
	*w = ob_v3(0, 0, 0);
	if (x->f->spin)
		ob_spin_at(x->f->spin, x->now.s, q, w);
}

static double advance_rims(const search *x, ob_vec3 normal, ob_vec3 turning, bool *lands)
{
	double least = INFINITY;
	for (int side = -1; side < 2; side += 2) {
		const double end = side * x->h.half.z;
		rim of = { .height = x->now.height - x->h.radius + end * normal.z,
			   .rate = x->now.speed + end * turning.z,
			   .most = fastest_fall(x) };
		of.lean = ob_scale(ob_v3(normal.x, normal.y, 0), x->h.rim);
		of.lean_rate = ob_scale(ob_v3(turning.x, turning.y, 0), x->h.rim);
		least = ob_min(least, rim_time(&of, x->tolerance));
	}
	*lands = least == 0;
	return least;
}

// Lower bound (s) of the time until a point of the outline lands; *lands: one does then.
static double advance(const search *x, bool *lands)
{
	const outline *h = &x->h;
	const double height = x->now.height - h->radius, speed = x->now.speed;
	ob_quat q;
	ob_vec3 w;
	attitude_of(x, &q, &w);
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 b = ob_rotate_back(&r, w), normal = ob_rotate_back(&r, x->n), turning = ob_cross(normal, b);
	if (h->rim > 0)
		return advance_rims(x, normal, turning, lands);
	const ob_vec3 c = x->bends.coupling, gain = ob_v3(c.x * b.y * b.z, c.y * b.z * b.x, c.z * b.x * b.y);
	const ob_vec3 turn = ob_add(ob_cross(normal, gain), ob_cross(turning, b));
	points of;
	if (h->corners) {
		hull_points(h->corners, height, normal, &of, of.gap);
		hull_points(h->corners, speed, turning, &of, of.rate);
		hull_points(h->corners, x->a, turn, &of, of.bend);
	} else {
		box_points(height, component(h->half, normal), of.gap);
		box_points(speed, component(h->half, turning), of.rate);
		box_points(x->a, component(h->half, turn), of.bend);
		of.pairs = BLOCK;
	}
	return land_points(&of, fastest_fall(x), h->reach * x->bends.jerk, x->tolerance, x->now.left, lands);
}

// Returns false if the search is over: it lands at *time, or not at all.
static bool search_begin(search *x, const ob_landing *of, double *time)
{
	const ob_flier *f = of->flier;
	*x = (search){ .f = f, .n = of->plane->normal, .until = of->until };
	x->known = outline_of(f, &x->h);
	x->radius = f->shape ? ob_shape_radius(f->shape, f->size) : f->size.x;
	x->p = ob_dot(x->n, f->p) - of->plane->offset, x->v = ob_dot(x->n, f->v), x->a = ob_dot(x->n, f->a);
	x->now.s = of->from;
	if (x->known && x->h.reach == 0) {
		*time = ob_time_of_closing(x->p - x->radius, x->v, x->a, of->until);
		if (*time >= of->from)
			return false;
	}
	x->bends = ob_bending_of(f->inertia, f->spin ? f->spin->fastest : 0);
	x->tolerance = near * x->radius + 8 * DBL_EPSILON * (ob_norm(f->p) + fabs(of->plane->offset));
	return true;
}

// Advances to the next instant that needs the attitude. Returns false if the search is over: it lands at *time, or not
// at all.
static bool search_go_on(search *x, double *time)
{
	double s = x->now.s;
	bool asks = false;
	if (x->advances++ < most_advances && s <= x->until) {
		double height = x->p + s * (x->v + .5 * s * x->a), speed = x->v + s * x->a;
		if (height > x->radius) { // until then no point can land, and the attitude is not needed
			s += ob_time_of_closing(height - x->radius, speed, x->a, x->until - s);
			height = x->p + s * (x->v + .5 * s * x->a), speed = x->v + s * x->a;
		}
		asks = s <= x->until && x->known;
		x->now = (instant){ s, height, speed, x->until - s };
	}
	*time = s <= x->until ? s : INFINITY;
	return asks;
}

// Advances by t without a landing. Returns false if it has landed at *time.
static bool search_advance(search *x, double t, bool lands, double *time)
{
	*time = x->now.s + t;
	x->now.s += ob_max(t, DBL_EPSILON * fabs(x->now.s));
	return !lands;
}

#ifdef OB_HAVE_MOTION_LANES
static ob_falling_box falling_box(const search *x)
{
	ob_falling_box box = { .half = x->h.half,
			       .normal = x->n,
			       .coupling = x->bends.coupling,
			       .height = x->now.height - x->h.radius,
			       .speed = x->now.speed,
			       .a = x->a,
			       .most = fastest_fall(x),
			       .jerk = x->h.reach * x->bends.jerk,
			       .tolerance = x->tolerance,
			       .left = x->now.left };
	attitude_of(x, &box.q, &box.w);
	return box;
}
// Advances the leading flights that are boxes side by side; returns their number.
static int advance_boxes(search *const *x, int n, double *t, bool *lands)
{
	ob_falling_box box[OB_LANES];
	int boxes = 0;
	while (boxes < n && boxes < OB_LANES && ob_shape_is(x[boxes]->f->shape, OB_SIDED))
		boxes++;
	if (boxes < 2 || !__builtin_cpu_supports("avx2"))
		return 0;
	for (int i = 0; i < boxes; i++)
		box[i] = falling_box(x[i]);
	ob_landing_lanes_advance(box, boxes, t, lands);
	return boxes;
}
#else
static int advance_boxes(search *const *x, int n, double *t, bool *lands)
{
	return 0;
}
#endif

static void advance_each(search *const *x, int n, double *t, bool *lands)
{
	for (int i = 0; i < n;) {
		const int boxes = advance_boxes(x + i, n - i, t + i, lands + i);
		if (!boxes)
			t[i] = advance(x[i], &lands[i]);
		i += boxes ? boxes : 1;
	}
}

void ob_landing_times(ob_landing *of, int n)
{
	search all[OB_LANDINGS], *on[OB_LANDINGS];
	bool searched[OB_LANDINGS], lands[OB_LANDINGS];
	double t[OB_LANDINGS], s[OB_LANDINGS];
	ob_spin *spin[OB_LANDINGS];
	int left = 0;
	for (int i = 0; i < n; i++) {
		searched[i] = search_begin(&all[i], &of[i], &of[i].time);
		left += searched[i];
	}
	while (left) {
		int asked = 0, spins = 0;
		for (int i = 0; i < n; i++) {
			if (!searched[i] || !(searched[i] = search_go_on(&all[i], &of[i].time)))
				continue;
			on[asked++] = &all[i];
			if (of[i].flier->spin)
				s[spins] = all[i].now.s, spin[spins++] = of[i].flier->spin;
		}
		ob_spin_prepare(spin, s, spins);
		advance_each(on, asked, t, lands);
		left = 0;
		for (int i = 0, k = 0; i < n; i++)
			if (searched[i]) {
				searched[i] = search_advance(&all[i], t[k], lands[k], &of[i].time);
				left += searched[i], k++;
			}
	}
}

double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until)
{
	ob_landing of = { .flier = f, .plane = plane, .from = from, .until = until };
	ob_landing_times(&of, 1);
	return of.time;
}
