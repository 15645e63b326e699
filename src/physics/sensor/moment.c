// A body's motion within the running step. See sensor.h.
//
// A body that contacts or joints have moved has states at the step's ends, 0 and 1, and when steps before began.
// Its centre, and the Gibbs vector g (tan of half the angle along the axis) of its turn from one that goes on at the begin's
// rate, are polynomials of degree 5 with the values and rates at -1, 0 and 1: errors are of the order h^6, those of rates
// h^5. Rates of this turn and of g are rational functions of each other:
//
//   w = 2 (g' + g x g') / (1 + g^2)         g' = (w + w x g + (w . g) g) / 2
//
// Accelerations are slopes of the polynomial through velocities at 1, 0, -1 .., by Newton's backward differences.
// Positions would add their rounding, divided by h^2. A difference of order k is a measure of the error of order
// k - 1, so the order is the one with the least: six where all is smooth, with errors of the order h^6, and one, which is
// the mean over the step, where there was a hit.
#include <string.h>

#include "motion/flight.h"
#include "sensor/sensor.h"

static const double smooth = .01; // difference of rates by degrees 5 and 3, as a share of the change in both steps
static const double least_cosine = .1; // cosine of half the turn in a step: with less the vector g is too long

// Three components as functions of s, in steps, of which the one before and this one are -1 .. 1.
typedef struct nodes {
	ob_vec3 x[2], v[2]; // at -1, 1, relative to x(0) = 0
	ob_vec3 v0;
} nodes;

typedef struct jet {
	ob_vec3 x, v; // value and rate
} jet;

static jet cubic(const nodes *n, double s)
{
	const ob_vec3 rise = ob_sub(n->x[1], n->v0), bend = ob_sub(n->v[1], n->v0), c3 = ob_madd(bend, -2, rise),
		      c2 = ob_sub(rise, c3);
	return (jet){ ob_madd(ob_madd(ob_scale(n->v0, s), s * s, c2), s * s * s, c3),
		      ob_madd(ob_madd(n->v0, 2 * s, c2), 3 * s * s, c3) };
}

static jet quintic(const nodes *n, double s)
{
	const ob_vec3 a = ob_sub(n->x[1], n->v0), b = ob_add(n->x[0], n->v0), c = ob_sub(n->v[1], n->v0),
		      d = ob_sub(n->v[0], n->v0);
	const ob_vec3 even = ob_scale(ob_add(a, b), .5), even_rate = ob_scale(ob_sub(c, d), .5),
		      odd = ob_scale(ob_sub(a, b), .5), odd_rate = ob_scale(ob_add(c, d), .5);
	const ob_vec3 c4 = ob_madd(ob_scale(even_rate, .5), -1, even), c2 = ob_sub(even, c4),
		      c5 = ob_scale(ob_madd(odd_rate, -3, odd), .5), c3 = ob_sub(odd, c5);
	const double s2 = s * s, s3 = s2 * s, s4 = s3 * s;
	return (jet){
		ob_madd(ob_madd(ob_madd(ob_madd(ob_scale(n->v0, s), s2, c2), s3, c3), s4, c4), s4 * s, c5),
		ob_madd(ob_madd(ob_madd(ob_madd(n->v0, 2 * s, c2), 3 * s2, c3), 4 * s3, c4), 5 * s4, c5),
	};
}

// known: the values at -1.
static jet between(const nodes *n, bool known, double s)
{
	const ob_vec3 change = ob_sub(n->v[1], n->v0);
	jet three = cubic(n, s);
	if (!known)
		return three;
	const jet five = quintic(n, s);
	const double most = smooth * (ob_norm(change) + ob_norm(ob_sub(n->v0, n->v[0])));
	if (ob_norm(ob_sub(five.v, three.v)) <= most)
		return five;
	three.v = ob_madd(n->v0, s, change);
	return three;
}

// Slope at s of the values at 1, 0, -1 .., n of them.
static ob_vec3 slope(ob_vec3 *x, uint64_t n, double s)
{
	ob_vec3 difference[OB_PAST_STEPS + 3], sum = { 0, 0, 0 };
	uint64_t order = 1;
	for (uint64_t k = 0; k < n; k++) {
		difference[k] = x[0];
		for (uint64_t i = 0; i + k + 1 < n; i++)
			x[i] = ob_sub(x[i], x[i + 1]);
	}
	for (uint64_t k = 2; k + 1 < n; k++)
		if (ob_norm(difference[k + 1]) < .5 * ob_norm(difference[order + 1]))
			order = k;
	double c = 1, rate = 0; // factor of the difference of order k, and its slope
	for (uint64_t k = 1; k <= order; k++) {
		rate = (rate * (s + (double)k - 2) + c) / (double)k;
		c *= (s + (double)k - 2) / (double)k;
		sum = ob_madd(sum, rate, difference[k]);
	}
	return sum;
}

// Sets the nodes on one side, -1 or 1. Returns false if the turn is too large.
static bool set_nodes(nodes *place, nodes *turn, int side, const ob_state *begin, const ob_state *x, double h)
{
	const ob_quat on = ob_quat_turn(begin->pose.q, ob_scale(begin->w, side ? h : -h)),
		      q = ob_quat_mul(x->pose.q, ob_quat_conjugate(on));
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 g = ob_scale(ob_v3(q.x, q.y, q.z), 1 / q.w), w = ob_sub(x->w, ob_rotate(&r, begin->w));
	place->x[side] = ob_sub(x->pose.p, begin->pose.p);
	place->v[side] = ob_scale(x->v, h);
	turn->x[side] = g;
	turn->v[side] = ob_scale(ob_madd(ob_add(w, ob_cross(w, g)), ob_dot(w, g), g), .5 * h);
	return fabs(q.w) >= least_cosine;
}

static void accelerate(ob_moment *m, const ob_state *begin, const ob_state *end, const ob_past *past, uint64_t known,
		       double h, double s)
{
	ob_vec3 v[OB_PAST_STEPS + 3] = { end->v, begin->v, past->before.v },
				  w[OB_PAST_STEPS + 3] = { end->w, begin->w, past->before.w };
	for (int i = 0; i < OB_PAST_STEPS; i++)
		v[3 + i] = past->older[i][0], w[3 + i] = past->older[i][1];
	m->a = ob_scale(slope(v, 2 + known, s), 1 / h);
	m->turn = ob_scale(slope(w, 2 + known, s), 1 / h);
}

static ob_moment interpolate(const ob_state *begin, const ob_state *end, const ob_past *past, uint64_t known, double h,
			     double s)
{
	nodes place = { .v0 = ob_scale(begin->v, h) }, turn = { .v0 = { 0, 0, 0 } };
	ob_moment m = { .state = *end };
	accelerate(&m, begin, end, past, known, h, s);
	if (!set_nodes(&place, &turn, 1, begin, end, h))
		return m; // it is about half a turn off
	known = known && set_nodes(&place, &turn, 0, begin, &past->before, h);
	const jet p = between(&place, known, s), g = between(&turn, known, s);
	m.state.pose.p = ob_add(begin->pose.p, p.x);
	const ob_quat q = ob_quat_normalize((ob_quat){ 1, g.x.x, g.x.y, g.x.z });
	const ob_mat3 r = ob_quat_matrix(q);
	m.state.pose.q = ob_quat_mul(q, ob_quat_turn(begin->pose.q, ob_scale(begin->w, h * s)));
	m.state.v = ob_scale(p.v, 1 / h);
	m.state.w = ob_madd(ob_rotate(&r, begin->w), 2 / (h * (1 + ob_norm2(g.x))), ob_add(g.v, ob_cross(g.x, g.v)));
	return m;
}

// By Euler's equations without a torque.
static ob_vec3 free_turn(ob_quat q, ob_vec3 w, ob_vec3 i)
{
	const ob_mat3 r = ob_quat_matrix(q);
	const ob_vec3 own = ob_rotate_back(&r, w), change = ob_cross(ob_v3(i.x * own.x, i.y * own.y, i.z * own.z), own);
	return i.x > 0 ? ob_rotate(&r, ob_v3(change.x / i.x, change.y / i.y, change.z / i.z)) : ob_v3(0, 0, 0);
}

static ob_moment by_closed_form(const ob_motion *m, const ob_passport *p, double t)
{
	ob_moment out = { .state = ob_published_at(m, p, t) };
	if (p->flags & OB_OBJECT_STATIC || m->flags & OB_MOTION_RESTS)
		return out;
	out.a = ob_acceleration_at(m, t);
	out.turn = free_turn(out.state.pose.q, out.state.w, p->inertia);
	return out;
}

// Motion before the step, of a body with another one since.
static const ob_motion *motion_before(const ob_universe *u, uint32_t id, double begin)
{
	const ob_motion *now = ob_newest_motion(u, id);
	return now->t0 > begin ? ob_previous_motion(u, id) : now;
}

static double step_begin(const ob_universe *u)
{
	return (double)ob_step_count(u) * ob_universe_settings(u)->step_length;
}

void ob_moment_pass(const ob_universe *u, uint32_t id, ob_past *past)
{
	const double begin = step_begin(u);
	for (int i = OB_PAST_STEPS - 1; i > 0; i--)
		memcpy(past->older[i], past->older[i - 1], sizeof past->older[i]);
	past->older[0][0] = past->before.v, past->older[0][1] = past->before.w;
	past->before = ob_published_at(motion_before(u, id, begin), ob_passport_of(u, id), begin);
}

ob_moment ob_moment_at(const ob_universe *u, uint32_t id, const ob_past *past, uint64_t known, double t)
{
	const double begin = step_begin(u), h = ob_universe_settings(u)->step_length;
	const ob_passport *p = ob_passport_of(u, id);
	const ob_motion *now = ob_newest_motion(u, id), *last = motion_before(u, id, begin);
	if (last == now || t > now->t0 || now->flags & OB_MOTION_FREE || p->flags & OB_OBJECT_PRESCRIBED)
		return by_closed_form(t < now->t0 ? last : now, p, t);
	const ob_state from = ob_published_at(last, p, begin), to = { { now->p, now->q }, now->v, now->w };
	const double span = now->t0 - begin;
	return interpolate(&from, &to, past, span < .999 * h ? 0 : known, span, (t - begin) / span);
}
