#include "solver/midpoint.h"

#include <string.h>

#include "motion/drift.h"
#include "shape/part.h"
#include "shape/shape.h"
#include "solver/bodies.h"
#include "solver/contacts.h"
#include "solver/impacts.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"

static const double least_turning = 1e-6; // m/s^2: less change of a row by turning is ignored
static const double least_face_turning = 5e-5; // the same with three held points, which leave no freedom to tilt
static const double longest_way = .2; // share of the smaller thickness: longest path of halved bodies in a partial
	// substep
static const double loose_gap = 1e-5; // m: a point farther off is not held at the surface, but for kept_gap
static const double still_share = 1e-3; // of the rate that turning adds: a slower point is at rest on the surface

// Returns the least change of velocity, m/s, in the partial substep that is noticed.
static double least_change(const ob_island_work *w, uint32_t held)
{
	const double least = held > 2 ? least_face_turning : least_turning;
	return least * w->unit.speed / w->unit.time * w->h;
}

// ---- contacts that take part

// True if a round body, or part, is on one that ends.
static bool rolls_on(const ob_body *round, const ob_hull *part, const ob_body *on)
{
	return ob_shape_is(ob_part_shape(round->shape, part), OB_ROUND) && !ob_shape_is(on->shape, OB_UNBOUNDED);
}

// Radius of the ball around a body, or around a round part and its own centre.
static double radius_of(const ob_body *body, const ob_hull *part)
{
	return ob_part_is_round(part) ? ob_shape_radius((ob_shape)part->round, part->size) : body->radius;
}

// Bounds the change of a row by turning in half the partial substep (m/s). The rows of a sphere turn with its centre,
// those of a plane are constant.
static double change_bound(const ob_island_work *w, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	double speed = ob_contact_speed(w, contact);
	double turn = ob_contact_turn_rate(w, w->v, contact);
	const ob_hull *const *part = contact->part;
	if (rolls_on(a, part[0], b) || rolls_on(b, part[1], a))
		turn += speed / ob_min(radius_of(a, part[0]), radius_of(b, part[1]));
	return .5 * w->h * turn * speed;
}

static bool turns_noticeably(const ob_island_work *w, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	if ((a->surface && !a->rolls && ob_norm2(ob_row_angular(w->v[contact->a])) > 0) ||
	    (b->surface && !b->rolls && ob_norm2(ob_row_angular(w->v[contact->b])) > 0))
		return false; // first order, except for carried bodies
	if (contact->lane == OB_NO_LANE)
		return false;
	const double change = change_bound(w, contact);
	return change > least_change(w, 0) &&
	       (ob_contact_load_of(w, contact) > 0 ||
		ob_contact_gap(w, contact) < loose_gap * w->unit.length + 2 * w->h * change) &&
	       (ob_shape_is(a->shape, OB_UNBOUNDED) || ob_shape_is(b->shape, OB_UNBOUNDED) ||
		ob_contact_speed(w, contact) * w->h < longest_way * ob_min(a->thickness, b->thickness));
}

// Marks the contact, and its bodies, if it takes part.
static void mark(ob_solver *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	contact->turns = s->methods.instants && !a->among_others && !b->among_others && turns_noticeably(w, contact);
	a->turns |= contact->turns;
	b->turns |= contact->turns;
}

void ob_midpoint_mark(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->rows; i++) {
		w->body[i].among_others = w->body[i].joints > 0;
		w->body[i].turns = false;
	}
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
		if (a->inv_mass > 0 && b->inv_mass > 0 && !(a->among_others && b->among_others) &&
		    ob_contact_in_reach(w, contact))
			a->among_others = b->among_others = true;
	}
	for (uint32_t i = 0; i < w->contacts; i++) {
		w->contact[i].held = 0;
		mark(s, &w->contact[i]);
	}
}

// ---- rows

// True if a point without load will hit within the partial substep, faster than by gravity's change of velocity in it.
static bool is_hit(const ob_solver *s, const ob_contact *contact)
{
	const ob_island_work *w = &s->island;
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES;
	for (uint32_t j = 0; j < contact->points; j++) {
		double rate = ob_batch_opening(b, l, j, w->v[contact->a], w->v[contact->b]) +
			      ob_batch_opening(b, l, j, w->dv[contact->a], w->dv[contact->b]);
		double gap = b->gap[j][l] + ob_batch_opening(b, l, j, w->d[contact->a], w->d[contact->b]);
		if (b->impulse[j][l] == 0 && rate < -2 * w->max_acceleration * w->h &&
		    gap + ob_impacts_slack(s, contact, j) + w->h * rate < 0)
			return true;
	}
	return false;
}

// ---- to the midpoint

void ob_midpoint_halve(ob_solver *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	double *v = w->v[row];
	if (body->surface && !body->halved)
		ob_surface_halve(s, row);
	if (body->halved || body->inv_mass == 0)
		return;
	ob_body_update_pose(w, row);
	body->halved = true;
	body->start_p = body->p;
	body->start_q = body->q;
	body->start_w = ob_row_angular(v);
	ob_vec3 way = ob_scale(ob_row_linear(v), .5 * w->h), rate;
	ob_quat q;
	ob_drift_held(body->q, body->start_w, body->inertia, .5 * w->h, &q, &rate);
	ob_body_place(body, ob_add(body->p, way), q);
	v[3] = rate.x, v[4] = rate.y, v[5] = rate.z;
	ob_vec3 turn = ob_small_turn(body->start_q, q);
	memcpy(body->first_half, (double[8]){ way.x, way.y, way.z, turn.x, turn.y, turn.z }, sizeof body->first_half);
}

// The previous geometry, kept while the new one is found.
typedef struct old_geometry {
	ob_vec3 arm_a[OB_PAIR_POINTS], arm_b[OB_PAIR_POINTS], normal;
	double since;
} old_geometry;

static ob_vec3 velocity_at(ob_vec3 v, ob_vec3 w, ob_vec3 arm)
{
	return ob_add(v, ob_cross(w, arm));
}

static ob_vec3 between(ob_vec3 from, ob_vec3 to, double share)
{
	return ob_madd(from, share, ob_sub(to, from));
}

static ob_vec3 start_rate(const ob_island_work *w, uint32_t row)
{
	return w->body[row].halved ? w->body[row].start_w : ob_row_angular(w->v[row]);
}

// Returns the part of a row's velocity due to turning: its velocity now less that at the start. A residual of turning
// at the start on which the impulse would do work is reversed, too.
static double turned(double now, double start, double impulse)
{
	return start * impulse < 0 || fabs(start) > fabs(now - start) ? now - start : now;
}

// Returns the gap (m) that a pressed point keeps. As seen from the midpoint the start's gap is off by a quarter of what turning
// adds. To close that would take the load away, and what approaches then would be stopped, which loses energy, in one partial
// substep after another.
static double kept_gap(const ob_island_work *w, double added)
{
	return loose_gap * w->unit.length + .3 * w->h * fabs(added);
}

// Sets the velocity by turning of each row. A point that opens at the midpoint may come back as fast, so no push on it
// does work. The start's geometry is interpolated between the one before and this; a new point moved with its bodies.
// Returns a bit for each point that is held. start_gap: m, of each point.
static unsigned set_turn(ob_island_work *w, const ob_contact *contact, const old_geometry *old, const double *start_gap)
{
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES, ia = contact->a, ib = contact->b;
	const double share = old->since / (old->since + .5 * w->h);
	const ob_vec3 n = ob_batch_vector(b->n, l), start_n = between(old->normal, n, share);
	const ob_vec3 va = ob_row_linear(w->v[ia]), vb = ob_row_linear(w->v[ib]), wa = ob_row_angular(w->v[ia]),
		      wb = ob_row_angular(w->v[ib]), wa0 = start_rate(w, ia), wb0 = start_rate(w, ib);
	const int points = (int)contact->points;
	ob_vec3 arm_a0[OB_PAIR_POINTS], arm_b0[OB_PAIR_POINTS];
	double gap[OB_PAIR_POINTS], most = 0;
	unsigned held_points = 0;
	for (uint32_t j = 0; j < contact->points; j++) {
		const int k = contact->was[j];
		const ob_vec3 ra = contact->arm_a[j], rb = contact->arm_b[j];
		arm_a0[j] = k < 0 ? ob_madd(ra, -.5 * w->h, ob_cross(wa, ra)) : between(old->arm_a[k], ra, share);
		arm_b0[j] = k < 0 ? ob_madd(rb, -.5 * w->h, ob_cross(wb, rb)) : between(old->arm_b[k], rb, share);
		ob_vec3 now = ob_sub(velocity_at(va, wa, ra), velocity_at(vb, wb, rb));
		ob_vec3 start = ob_sub(velocity_at(va, wa0, arm_a0[j]), velocity_at(vb, wb0, arm_b0[j]));
		const double opens = ob_dot(n, now), added = opens - ob_dot(start_n, start);
		const bool stays = added < 0 && fabs(opens - added) <= still_share * -added,
			   pressed = b->impulse[j][l] > 0 || stays, held = pressed && start_gap[j] < kept_gap(w, added);
		held_points |= (unsigned)held << j;
		b->turn[j][l] = ob_max(opens, held ? added : 0);
		most = ob_max(most, ob_max(b->turn[j][l], pressed ? fabs(added) : 0));
		gap[j] = b->gap[j][l];
	}
	ob_vec3 at_a, at_b;
	ob_vec3 slide = ob_sub(velocity_at(va, wa, contact->friction_a), velocity_at(vb, wb, contact->friction_b));
	ob_friction_arms(arm_a0, arm_b0, gap, ob_contact_leans(contact) ? 1 : points, start_n, &at_a, &at_b);
	const ob_vec3 slide_start = ob_sub(velocity_at(va, wa0, at_a), velocity_at(vb, wb0, at_b));
	const ob_vec3 t1 = ob_batch_vector(b->t1, l), t2 = ob_batch_vector(b->t2, l);
	const ob_vec3 friction = ob_add(ob_scale(t1, b->impulse[4][l]), ob_scale(t2, b->impulse[5][l]));
	const ob_vec3 added = ob_sub(slide, slide_start);
	most = ob_max(most, ob_max(fabs(ob_dot(t1, added)), fabs(ob_dot(t2, added))));
	if (ob_contact_leans(contact) || ob_dot(friction, slide_start) < 0 || ob_norm2(slide_start) > ob_norm2(added))
		slide = added; // reversed, the slip of a rim that rolls would go to and fro for good
	b->turn[4][l] = ob_dot(slide, t1);
	b->turn[5][l] = ob_dot(slide, t2);
	b->turn[6][l] = turned(ob_dot(n, ob_sub(wa, wb)), ob_dot(start_n, ob_sub(wa0, wb0)), b->impulse[6][l]);
	if (most > least_change(w, (uint32_t)__builtin_popcount(held_points)))
		b->turning |= 1u << l;
	return held_points;
}

// Finds the contact at the midpoint, with the gaps at the start as extrapolated from there.
static void find_at_midpoint(ob_solver *s, ob_contact *contact)
{
	ob_island_work *w = &s->island;
	const ob_batch *before = &w->batch[contact->lane / OB_LANES];
	old_geometry old = { .normal = ob_batch_vector(before->n, contact->lane % OB_LANES), .since = contact->since };
	memcpy(old.arm_a, contact->arm_a, sizeof old.arm_a);
	memcpy(old.arm_b, contact->arm_b, sizeof old.arm_b);
	contact->held = 0;
	s->counters.narrowphase_tests++;
	ob_contact_find(s, contact);
	if (contact->lane == OB_NO_LANE)
		return;
	contact->since = -.5 * w->h;
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES;
	double gap[OB_PAIR_POINTS];
	for (uint32_t j = 0; j < contact->points; j++)
		gap[j] = b->gap[j][l] + ob_impacts_slack(s, contact, j) -
			 ob_batch_opening(b, l, j, w->body[contact->a].first_half, w->body[contact->b].first_half);
	contact->held = set_turn(w, contact, &old, gap);
	for (uint32_t j = 0; j < contact->points; j++)
		b->gap[j][l] = contact->held >> j & 1 ? ob_min(gap[j], 0) : gap[j];
}

static bool at_midpoint(const ob_island_work *w, const ob_contact *contact)
{
	return contact->turns && contact->lane != OB_NO_LANE &&
	       (w->body[contact->a].halved || w->body[contact->b].halved);
}

static bool concerns_turning(const ob_island_work *w, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	return (a->inv_mass > 0 && a->turns) || (b->inv_mass > 0 && b->turns);
}

// True if contacts turn and nothing hits their bodies.
static bool all_go_on(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	bool any = false;
	for (uint32_t i = 0; i < w->contacts; i++)
		any |= w->contact[i].turns && w->contact[i].lane != OB_NO_LANE;
	for (uint32_t i = 0; any && i < w->contacts; i++)
		any = w->contact[i].lane == OB_NO_LANE || !concerns_turning(w, &w->contact[i]) ||
		      !(w->contact[i].as_of_instant || is_hit(s, &w->contact[i]));
	return any;
}

// Goes back: finds all contacts at the start.
static void leave_midpoint(ob_solver *s)
{
	ob_island_work *w = &s->island;
	bool any = false;
	for (uint32_t i = 0; i < w->contacts; i++) {
		any |= w->contact[i].turns;
		w->contact[i].turns = false;
	}
	if (any && ob_contacts_update(s, w->h)) {
		ob_contacts_prepare(s);
		ob_bodies_warm_start(s);
	}
}

void ob_midpoint_begin(ob_solver *s)
{
	ob_island_work *w = &s->island;
	ob_solver_enter(s, OB_PROFILE_NARROWPHASE);
	for (uint32_t i = 0; i < w->contacts; i++) { // those that have touched only since all were marked
		ob_contact *contact = &w->contact[i];
		if (contact->began && !contact->turns && contact->since == 0 && !contact->as_of_instant)
			mark(s, contact);
	}
	if (!all_go_on(s)) {
		leave_midpoint(s);
		return;
	}
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		const bool known = contact->since >= 0 && contact->since < 2 * w->h && contact->found_for >= w->h;
		if (contact->turns && !known)
			ob_contact_find(s, contact);
		contact->turns &= contact->lane != OB_NO_LANE && contact->since < INFINITY;
	}
	for (uint32_t i = 0; i < w->contacts; i++)
		if (w->contact[i].turns)
			ob_midpoint_halve(s, w->contact[i].a), ob_midpoint_halve(s, w->contact[i].b);
	for (uint32_t i = 0; i < w->contacts; i++)
		if (at_midpoint(w, &w->contact[i]))
			find_at_midpoint(s, &w->contact[i]);
	ob_contacts_prepare(s);
	ob_bodies_warm_start(s);
}

void ob_midpoint_undo(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 1; i <= w->bodies; i++) {
		ob_body *body = &w->body[i];
		if (!body->halved)
			continue;
		ob_body_place(body, body->start_p, body->start_q);
		w->v[i][3] = body->start_w.x, w->v[i][4] = body->start_w.y, w->v[i][5] = body->start_w.z;
		body->halved = false;
	}
	ob_surfaces_undo_halves(s);
	for (uint32_t i = 0; i < w->batches; i++)
		w->batch[i].turning = 0;
}

void ob_midpoint_end(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++)
		w->contact[i].since += w->h;
	for (uint32_t i = 0; i < w->batches; i++)
		w->batch[i].turning = 0;
	for (uint32_t i = 0; i < w->rows; i++)
		w->body[i].halved = false;
}
