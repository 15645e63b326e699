#include "contact/manifold.h"

#include <float.h>

#include "contact/pairs.h"
#include "contact/support.h"
#include "motion/drift.h"
#include "shape/part.h"
#include "shape/shape.h"

typedef void pair_function(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#define OB_PAIR_ENTRY(A, B, name) [OB_SHAPE_##A][OB_SHAPE_##B] = name,

// By the shapes of a and b. A missing pair is found with a and b exchanged, if there is one.
static pair_function *const pair_functions[OB_SHAPE_KINDS][OB_SHAPE_KINDS] = { OB_PAIRS(OB_PAIR_ENTRY) };

static void flip(ob_manifold *m)
{
	m->normal = ob_scale(m->normal, -1);
}

const ob_placed *ob_placed_own(const ob_placed *x, ob_placed *room)
{
	if (!ob_part_is_round(x->hull))
		return x;
	*room = *x;
	room->shape = (ob_shape)x->hull->round;
	room->size = x->hull->size;
	room->hull = NULL;
	ob_part_enter(x->hull, &room->p, &room->r);
	room->v = ob_add(x->v, ob_cross(x->w, ob_sub(room->p, x->p)));
	return room;
}

bool ob_manifold_find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out)
{
	ob_placed part[2];
	a = ob_placed_own(a, &part[0]);
	b = ob_placed_own(b, &part[1]);
	if (pair_functions[a->shape][b->shape]) {
		pair_functions[a->shape][b->shape](a, b, margin, out);
	} else if (pair_functions[b->shape][a->shape]) {
		pair_functions[b->shape][a->shape](b, a, margin, out);
		flip(out);
	} else {
		out->points = 0;
		out->separation = INFINITY;
		return false;
	}
	return true;
}

// ---- time of impact

enum { MOST_TRIES = 256 };

static const double longest_short_turn = .2; // rad: up to here the short formula errs by less than 1e-5 rad

// Moving shape: v is constant, and it turns freely.
typedef struct moving_shape {
	const ob_placed *from; // at t = 0
	ob_vec3 rate; // rad/s, in the frame of the shape
	double speed; // rad/s
	ob_spin spin; // from the identity
} moving_shape;

static void set_off(const ob_placed *x, moving_shape *o)
{
	o->from = x;
	o->rate = ob_rotate_back(&x->r, x->w);
	o->speed = ob_shape_is(x->shape, OB_ISOTROPIC) ? 0 : ob_norm(x->w);
	ob_spin_plan(&o->spin, ob_quat_identity(), o->rate, x->inertia);
}

static ob_mat3 turned_by(const ob_mat3 *r, ob_quat turn)
{
	const ob_mat3 t = ob_quat_matrix(turn);
	ob_mat3 out;
	for (int c = 0; c < 3; c++) {
		ob_vec3 axis = ob_rotate(r, ob_column(&t, c));
		out.m[0][c] = axis.x, out.m[1][c] = axis.y, out.m[2][c] = axis.z;
	}
	return out;
}

// Angular velocity (rad/s, world) at the attitude of "now": the angular momentum stays.
static ob_vec3 rate_at(const moving_shape *x, const ob_placed *now)
{
	const ob_vec3 i = x->from->inertia, b = x->rate;
	if (!(x->speed > 0))
		return ob_v3(0, 0, 0);
	if (!(i.x > 0 && i.y > 0 && i.z > 0))
		return x->from->w;
	const ob_vec3 l = ob_rotate_back(&now->r, ob_rotate(&x->from->r, ob_v3(i.x * b.x, i.y * b.y, i.z * b.z)));
	return ob_rotate(&now->r, ob_v3(l.x / i.x, l.y / i.y, l.z / i.z));
}

// A shape that is followed from instant to instant, to 1e-5 rad.
typedef struct followed_shape {
	moving_shape shape;
	ob_placed now;
	double t; // s
} followed_shape;

// Begins at t = 0. Works in place, since an ob_spin is large.
static void follow_from_start(const ob_placed *x, followed_shape *f)
{
	f->now = *x;
	f->t = 0;
	set_off(x, &f->shape);
}

// Attitude at t, turned from that at the start.
static ob_mat3 turned_from_start(followed_shape *f, double t)
{
	const moving_shape *x = &f->shape;
	ob_quat turn;
	ob_vec3 rate;
	if (x->speed * t <= longest_short_turn)
		turn = ob_drift_short_turn(x->rate, f->now.inertia, t);
	else
		ob_spin_at(&f->shape.spin, t, &turn, &rate);
	return turned_by(&x->from->r, turn);
}

// True if the shape reaches a later instant t by turning on from its last attitude.
static bool turns_on(const followed_shape *f, double t)
{
	const moving_shape *x = &f->shape;
	const bool far = x->speed * t > longest_short_turn;
	return far && f->t > 0 && x->spin.fastest * (t - f->t) < longest_short_turn;
}

// Moves the shape to a later instant t.
static void follow_to(followed_shape *f, double t)
{
	const moving_shape *x = &f->shape;
	const double more = t - f->t;
	if (x->speed > 0 && more > 0) {
		if (turns_on(f, t))
			f->now.r = turned_by(&f->now.r, ob_drift_short_turn(ob_rotate_back(&f->now.r, f->now.w),
									    f->now.inertia, more));
		else
			f->now.r = turned_from_start(f, t);
		f->now.w = rate_at(x, &f->now);
	}
	f->now.p = ob_madd(x->from->p, t, x->from->v);
	f->t = t;
}

// True if a later instant t needs the closed form of its rotation.
static bool asks_for_rotation(const followed_shape *f, double t)
{
	const moving_shape *x = &f->shape;
	return x->speed * t > longest_short_turn && t > f->t && !turns_on(f, t);
}

static void follow_both_to(followed_shape *a, followed_shape *b, double t)
{
	if (asks_for_rotation(a, t) && asks_for_rotation(b, t))
		ob_spin_prepare((ob_spin *[]){ &a->shape.spin, &b->shape.spin }, (double[]){ t, t }, 2);
	follow_to(a, t);
	follow_to(b, t);
}

// Bound on the acceleration (m/s^2) of any point of a shape that turns at up to "fastest" (rad/s); infinity for a
// plane.
static double bend_at(const ob_placed *x, double fastest)
{
	const double radius = ob_shape_radius(x->shape, x->size);
	if (isinf(radius) || !(fastest > 0))
		return isinf(radius) ? INFINITY : 0;
	return radius * ob_bending_of(x->inertia, fastest).most;
}

static double bend_of(const moving_shape *x)
{
	return bend_at(x->from, x->speed > 0 ? x->spin.fastest : 0);
}

// Two shapes at an instant, as seen along a direction n from b to a, which may turn. centres: m, distance of their
// centres along n; rate: m/s, its rate; turn_a, turn_b: 1/s, rate of n as seen from a and b; bend: m/s^2, bound on the
// acceleration that brings points closer besides.
typedef struct seen_along {
	const ob_placed *a, *b;
	ob_vec3 n, turn_a, turn_b;
	ob_vec3 apart, v; // m, m/s: position and velocity of a from b
	double centres, rate, bend;
	bool boxes; // both are boxes; half: m, half sides of a and b along n; turn: m/s, their rates
	double half[6], turn[6];
} seen_along;

// Lower bound on the distance of the shapes at t (m): a concave function of t. As seen from a turning shape, n turns
// the other way. To first order this gives the places of its points along n; "bend" bounds the remaining effect of
// turning.
static double apart_at(const seen_along *x, double t)
{
	if (x->boxes) {
		double reach = 0;
		for (int k = 0; k < 6; k++)
			reach += fabs(x->half[k] + t * x->turn[k]);
		return x->centres + t * (x->rate - .5 * t * x->bend) - reach;
	}
	const ob_vec3 na = ob_madd(x->n, t, x->turn_a), nb = ob_madd(x->n, t, x->turn_b);
	return x->centres + t * (x->rate - .5 * t * x->bend) - ob_reach(x->a, ob_scale(na, -1)) - ob_reach(x->b, nb);
}

// Speed of the shape's points by turning (m/s), at most.
static double rim_speed(const ob_placed *x)
{
	return ob_shape_is(x->shape, OB_ISOTROPIC) ? 0 : ob_norm(x->w) * ob_shape_radius(x->shape, x->size);
}

static ob_vec3 turn_seen_by(const ob_placed *x, ob_vec3 n)
{
	return ob_shape_is(x->shape, OB_ISOTROPIC) ? ob_v3(0, 0, 0) : ob_cross(n, x->w);
}

// View along n, which is constant. bend: m/s^2, of both shapes together
static seen_along look_along(const ob_placed *a, const ob_placed *b, ob_vec3 n, double bend)
{
	seen_along x;
	x.a = a, x.b = b, x.n = n;
	x.turn_a = turn_seen_by(a, n);
	x.turn_b = turn_seen_by(b, n);
	x.apart = ob_sub(a->p, b->p);
	x.v = ob_sub(a->v, b->v);
	x.centres = ob_dot(n, x.apart);
	x.rate = ob_dot(n, x.v);
	x.bend = bend;
	x.boxes = false;
	return x;
}

static void project_sides(const ob_placed *x, ob_vec3 n, double out[3])
{
	const ob_vec3 along = ob_rotate_back(&x->r, n);
	out[0] = x->size.x * along.x, out[1] = x->size.y * along.y, out[2] = x->size.z * along.z;
}

// Sets the half sides of two boxes along n, for a forecast: it is called often, and need not be exact.
static void take_sides(seen_along *x)
{
	x->boxes = ob_shape_is(x->a->shape, OB_SIDED) && ob_shape_is(x->b->shape, OB_SIDED);
	if (!x->boxes)
		return;
	project_sides(x->a, x->n, x->half);
	project_sides(x->b, x->n, x->half + 3);
	project_sides(x->a, x->turn_a, x->turn);
	project_sides(x->b, x->turn_b, x->turn + 3);
}

// Same view with n turning at "turn" (1/s, across n). h: s, duration for which it holds
static seen_along look_turning(const seen_along *still, ob_vec3 turn, double h)
{
	seen_along x = *still;
	const double turning = ob_norm(turn);
	x.turn_a = ob_add(x.turn_a, turn);
	x.turn_b = ob_add(x.turn_b, turn);
	x.rate += ob_dot(turn, x.apart);
	x.bend = ob_max(0, x.bend * (1 + h * turning) +
				   2 * (turning * (rim_speed(x.a) + rim_speed(x.b)) - ob_dot(turn, x.v)));
	if (x.boxes) {
		project_sides(x.a, x.turn_a, x.turn);
		project_sides(x.b, x.turn_b, x.turn + 3);
	}
	return x;
}

// Axis of the shape that is most nearly across n: the direction of an edge that touches along n.
static ob_vec3 axis_across(const ob_placed *x, ob_vec3 n)
{
	ob_vec3 best = ob_column(&x->r, 0);
	for (int k = 1; k < 3; k++)
		if (fabs(ob_dot(ob_column(&x->r, k), n)) < fabs(ob_dot(best, n)))
			best = ob_column(&x->r, k);
	return best;
}

// Rate (1/s) of n if it stays across an edge of each shape; 0 for nearly parallel edges.
static ob_vec3 turn_with_edges(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	const double least = .01;
	const ob_vec3 u = axis_across(a, n), v = axis_across(b, n);
	const double sine = ob_dot(n, ob_cross(u, v));
	if (fabs(sine) < least)
		return ob_v3(0, 0, 0);
	const double along_u = -ob_dot(u, ob_cross(n, a->w)), along_v = -ob_dot(v, ob_cross(n, b->w));
	return ob_scale(ob_sub(ob_scale(ob_cross(v, n), along_u), ob_scale(ob_cross(u, n), along_v)), 1 / sine);
}

// Takes n as *best if the shapes are farther apart along it than *most (m).
static void try_direction(const ob_placed *a, const ob_placed *b, ob_vec3 n, ob_vec3 *best, double *most)
{
	const double least = 1e-6, length = ob_norm(n);
	if (!(length > least)) // parallel axes, or no direction
		return;
	n = ob_scale(n, (ob_dot(n, ob_sub(ob_middle(a), ob_middle(b))) < 0 ? -1 : 1) / length);
	const double apart = ob_apart_along(a, b, n);
	if (apart > *most)
		*most = apart, *best = n;
}

// Finds a direction along which the shapes are nearly as far apart as is known (m), if there is one. Tries the last one
// (or 0), the axes of both, the line of their centres, and the directions across two axes. Returns the separation along
// it.
static double find_direction(const ob_placed *a, const ob_placed *b, double known, ob_vec3 *along)
{
	const double enough = .9 * known;
	double most = -INFINITY;
	try_direction(a, b, *along, along, &most);
	for (int k = 0; k < 6 && most < enough; k++)
		try_direction(a, b, ob_column(k < 3 ? &a->r : &b->r, k % 3), along, &most);
	if (most < enough)
		try_direction(a, b, ob_sub(ob_middle(a), ob_middle(b)), along, &most);
	for (int k = 0; k < 9 && most < enough; k++)
		try_direction(a, b, ob_cross(ob_column(&a->r, k / 3), ob_column(&b->r, k % 3)), along, &most);
	return most;
}

// Lower bound (s) on the time within h for which the shapes stay farther apart than "near" (m). certain: s, a known
// bound.
static double time_apart(const seen_along *x, double near, double certain, double h)
{
	enum { NARROW = 2 };
	const double farther = 4;
	double low = 0, at_low = apart_at(x, 0) - near;
	if (at_low <= 0 || apart_at(x, h) >= near)
		return at_low <= 0 ? certain : h;
	const double high = ob_min(h, farther * certain), at_high = apart_at(x, high) - near;
	if (at_high >= 0)
		return high;
	for (int k = 0; k < NARROW && at_low > 0; k++) { // a chord lies below the function
		low += (high - low) * (at_low / (at_low - at_high));
		at_low = apart_at(x, low) - near;
	}
	return ob_max(certain, low);
}

// Lower bound (s) on the time within h until shapes that are "apart" (m) close: the first zero of a concave function. A
// chord reaches zero before it, the extension of a chord after it.
static double time_to_close(const seen_along *x, double apart, double h)
{
	enum { NARROW = 5 };
	double low = 0, at_low = apart, high = h, at_high = apart_at(x, h);
	if (at_high >= 0)
		return h;
	for (int k = 0; k < NARROW; k++) {
		const double next = low + (high - low) * (at_low / (at_low - at_high)), at_next = apart_at(x, next);
		if (!(next > low) || !(at_next >= 0))
			break;
		const double beyond = at_next < at_low ? next + (next - low) * (at_next / (at_low - at_next)) : high;
		low = next, at_low = at_next;
		if (!(beyond < high))
			continue;
		const double at_beyond = apart_at(x, beyond);
		if (at_beyond < 0)
			high = beyond, at_high = at_beyond;
		else
			low = beyond, at_low = at_beyond;
	}
	return low;
}

// Lower bound (s) on the time within h for which touching shapes part; 0: they do not. A concave function never regains
// what it loses at once.
static double time_of_parting(const seen_along *x, double apart, double h)
{
	const double shorter = .25, shortest = 1e-8 * h, least = ob_max(apart, 0);
	double t = h;
	if (apart_at(x, shortest) < least)
		return 0;
	while (t > shortest && apart_at(x, t) < least)
		t *= shorter;
	return ob_max(t, shortest);
}

// Lower bound (s) on the time within h for which the shapes stay apart, or part if they touch ("touch"). apart: m,
// along n. n is constant in the world, or turns with a face of one of them, or with edges of both, whichever gives the
// longest time. A shape may part from a turning face that it touches, although it would not part from a constant plane.
// bend: m/s^2, of both.
static double time_clear(const ob_placed *a, const ob_placed *b, ob_vec3 n, double apart, double bend, bool touch,
			 double h)
{
	enum { TURNS = 4 };
	const ob_vec3 turn[TURNS] = { { 0, 0, 0 }, ob_cross(a->w, n), ob_cross(b->w, n), turn_with_edges(a, b, n) };
	const double soon = h / 1024;
	seen_along x[TURNS];
	double most = -INFINITY, longest;
	int best = 0;
	x[0] = look_along(a, b, n, bend);
	for (int k = 0; k < TURNS; k++) {
		if (k)
			x[k] = look_turning(&x[0], turn[k], h);
		const double then = apart_at(&x[k], soon);
		if (then > most)
			most = then, best = k;
	}
	longest = touch ? time_of_parting(&x[best], apart, h) : time_to_close(&x[best], apart, h);
	for (int k = 0; k < TURNS && longest < soon; k++)
		if (k != best)
			longest = ob_max(longest,
					 touch ? time_of_parting(&x[k], apart, h) : time_to_close(&x[k], apart, h));
	return longest;
}

// Distance (m) that rounding cannot tell from contact.
static double rounding_of(const ob_placed *x)
{
	return 8 * DBL_EPSILON * (ob_shape_radius(x->shape, x->size) + ob_norm(x->p));
}

// Upper bound on the angular speed (rad/s), at any time.
static double fastest_of(const ob_turning *x)
{
	return x->spin ? x->spin->fastest : 0;
}

// Upper bound on the closing speed (m/s) of any points of the two.
static double fastest_closing(const ob_placed *a, double turning_a, const ob_placed *b, double turning_b)
{
	double speed = ob_norm(ob_sub(a->v, b->v));
	if (turning_a > 0)
		speed += turning_a * ob_shape_radius(a->shape, a->size);
	if (turning_b > 0)
		speed += turning_b * ob_shape_radius(b->shape, b->size);
	return ob_max(speed, DBL_MIN);
}

static void turn_to(const ob_turning *turning, double t, ob_placed *now)
{
	ob_quat q;
	if (!turning->spin)
		return;
	ob_spin_at(turning->spin, turning->since + t, &q, &now->w);
	now->r = ob_quat_matrix(q);
}

// Places both shapes at t, to rounding. Long rotations are evaluated side by side.
static void place_both(const ob_placed *a, const ob_placed *b, const ob_turning turning[2], double t, ob_placed now[2])
{
	if (turning[0].spin && turning[1].spin)
		ob_spin_prepare((ob_spin *[]){ turning[0].spin, turning[1].spin },
				(double[]){ turning[0].since + t, turning[1].since + t }, 2);
	turn_to(&turning[0], t, &now[0]);
	turn_to(&turning[1], t, &now[1]);
	now[0].p = ob_madd(a->p, t, a->v);
	now[1].p = ob_madd(b->p, t, b->v);
}

bool ob_time_of_touch(const ob_placed *a, const ob_placed *b, const ob_turning turning[2], double h, double margin,
		      ob_manifold_finder find, double *when, ob_manifold *out)
{
	enum { MOST_ADVANCES = 64 };
	const double turning_a = fastest_of(&turning[0]), turning_b = fastest_of(&turning[1]);
	const double bend = bend_at(a, turning_a) + bend_at(b, turning_b),
		     speed = fastest_closing(a, turning_a, b, turning_b);
	ob_placed now[2] = { *a, *b };
	const double exact = rounding_of(a) + rounding_of(b);
	ob_vec3 n = { 0, 0, 0 };
	double t = 0, first = 0;
	*when = INFINITY;
	if (!isfinite(bend) || find.of_boxes)
		return false;
	for (int tries = 0; tries < MOST_ADVANCES; tries++) {
		const double left = h - t;
		*out = (ob_manifold){ .normal = n, .valid_path = INFINITY };
		find.find(find.with, &now[0], &now[1], margin, out);
		n = out->normal;
		if (tries == 0)
			first = out->separation;
		if (out->separation < -margin)
			return false;
		const double apart = find_direction(&now[0], &now[1], out->separation - exact, &n);
		const bool touch = out->separation <= exact;
		double clear = ob_max(0, out->separation - exact) / speed;
		if (touch || apart > exact)
			clear = ob_max(clear, time_clear(&now[0], &now[1], n, apart, bend, touch, left));
		if (clear >= left) {
			out->points = 0;
			out->separation = first;
			return true;
		}
		if (touch && clear == 0) {
			*when = t;
			return out->points > 0;
		}
		t += ob_max(clear, DBL_EPSILON * t);
		place_both(a, b, turning, t, now);
	}
	return false;
}

double ob_time_of_impact(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance,
			 double margin, ob_manifold_finder find, ob_manifold *out)
{
	double t = 0, apart = 0;
	followed_shape at, bt;
	follow_from_start(a, &at);
	follow_from_start(b, &bt);
	const double bend = bend_of(&at.shape) + bend_of(&bt.shape);
	const bool by_direction = isfinite(bend) && !find.of_boxes;
	ob_vec3 n = { 0, 0, 0 };
	// A grazing flight takes many small advances. After too many, shapes this near count as touching.
	for (int tries = 0; tries < MOST_TRIES && t <= h; tries++) {
		follow_both_to(&at, &bt, t);
		out->normal = n;
		find.find(find.with, &at.now, &bt.now, tolerance, out);
		n = out->normal;
		if (tries == 0)
			apart = out->separation;
		if (out->points && margin == tolerance)
			return t;
		if (out->points)
			break;
		const double near = .5 * tolerance, certain = (ob_max(out->separation, tolerance) - near) / speed;
		double advance = certain;
		if (by_direction && t + certain < h && find_direction(&at.now, &bt.now, out->separation, &n) > near) {
			const seen_along x = look_along(&at.now, &bt.now, n, bend);
			advance = time_apart(&x, near, certain, h - t);
		}
		t += advance;
	}
	if (t <= h) {
		follow_both_to(&at, &bt, t);
		find.find(find.with, &at.now, &bt.now, margin, out);
		if (out->points)
			return t;
	}
	out->points = 0;
	out->separation = apart;
	return t <= h && margin == tolerance ? t : INFINITY;
}

// ---- a forecast

// Time (s) until which the shapes may be nearer than "near" (m): then their bounding spheres have parted for good.
static double time_of_passing(const ob_placed *a, const ob_placed *b, double near)
{
	const ob_vec3 apart = ob_sub(a->p, b->p), v = ob_sub(a->v, b->v);
	const double radii = ob_shape_radius(a->shape, a->size) + ob_shape_radius(b->shape, b->size) + near;
	const double opening = ob_dot(apart, v), square = ob_norm2(v),
		     d = opening * opening - square * (ob_norm2(apart) - radii * radii);
	if (!(square > 0))
		return INFINITY;
	return d > 0 ? ob_max(0, (sqrt(d) - opening) / square) : 0;
}

// Rate (1/s) of n if it turns with the features that it is across: a face, or an edge of each.
static ob_vec3 turn_with_features(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	const double same = 1 - 1e-9;
	for (int k = 0; k < 6; k++)
		if (fabs(ob_dot(ob_column(k < 3 ? &a->r : &b->r, k % 3), n)) > same)
			return ob_cross(k < 3 ? a->w : b->w, n);
	return turn_with_edges(a, b, n);
}

// Lower bound (s) on the time within h for which the shapes stay farther apart than "near" (m) along n. certain: s, a
// known bound. A constant n gives more for distant shapes. An n that turns with its features gives more for close ones:
// there the face is nearer than its corners. Returns infinity if the time is all of h, and they are then farther apart
// than "far" (m).
static double time_beyond(const ob_placed *a, const ob_placed *b, ob_vec3 n, double bend, double near, double far,
			  double certain, double h)
{
	enum { NARROW = 4, LONGER = 8 };
	seen_along x = look_along(a, b, n, bend);
	take_sides(&x);
	if (apart_at(&x, h) >= far)
		return INFINITY;
	double high = ob_min(h, LONGER * certain), at_high = apart_at(&x, high) - near, low = 0, at_low;
	const seen_along turning = look_turning(&x, turn_with_features(a, b, n), high);
	const double at_turned = apart_at(&turning, high) - near;
	if (at_turned > at_high)
		x = turning, at_high = at_turned;
	if (at_high >= 0)
		return high;
	at_low = apart_at(&x, 0) - near;
	for (int k = 0; k < NARROW && at_low > 0; k++) { // a chord lies below the function
		low += (high - low) * (at_low / (at_low - at_high));
		at_low = apart_at(&x, low) - near;
	}
	return ob_max(certain, low);
}

double ob_time_of_nearing(const ob_placed *a, const ob_placed *b, double speed, double h, double soon, double near,
			  ob_manifold_finder find, double *apart)
{
	const double closer = .5 * near, least = .25 * soon;
	followed_shape at, bt;
	follow_from_start(a, &at);
	follow_from_start(b, &bt);
	const double bend = bend_of(&at.shape) + bend_of(&bt.shape);
	const bool by_direction = isfinite(bend) && !find.of_boxes;
	const double end = by_direction ? ob_min(h, time_of_passing(a, b, near)) : h;
	ob_manifold m;
	ob_vec3 n = { 0, 0, 0 };
	double t = 0;
	for (int tries = 0; tries < MOST_TRIES && t <= end; tries++) {
		follow_both_to(&at, &bt, t);
		m = (ob_manifold){ .normal = n, .valid_path = INFINITY };
		find.find(find.with, &at.now, &bt.now, near, &m);
		n = m.normal;
		if (tries == 0)
			*apart = m.separation;
		if (m.points)
			return t;
		const double certain = (ob_max(m.separation, near) - closer) / speed;
		double advance = certain;
		if (by_direction && t + certain < end && find_direction(&at.now, &bt.now, m.separation, &n) > closer)
			advance = time_beyond(&at.now, &bt.now, n, bend, closer, near, certain, end - t);
		t += advance;
		if (t > soon && t < end && advance < least)
			return t;
	}
	return t <= end ? t : INFINITY;
}
