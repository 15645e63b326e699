#include "solver/adaptive_substep.h"

#include <string.h>

#include "shape/part.h"
#include "shape/shape.h"
#include "solver/bodies.h"
#include "solver/contacts.h"
#include "solver/midpoint.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"

// Bound of the turn (rad) and slide (share of the smaller thickness) of two touching bodies in a partial substep.
static const double max_motion = .03;
static const double max_round = .05; // rad: bound of the way of a contact round a rim in a partial substep
static const double most_parts = 16; // partial substeps in a substep that it asks for at most
static const double unnoticed = .5; // share of the tolerance that a turn may use in a coarse run
static const double fast_share = 1. / 10; // least share of both bounds, for bodies that outrun their thickness
static const double touching_gap = 1e-3; // m: a smaller gap counts as contact, as in a swept test
static const double max_partial_substeps = 1024; // in a substep

// Time (s) for which a contact's points and normal stay valid, at the velocities in rows. Slide does not count for
// planes, which are the same everywhere. A sphere's point moves with its centre.
static double geometry_lifetime(const ob_island_work *w, const ob_body_row *rows, const ob_contact *contact)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	double turn = ob_contact_turn_rate(w, rows, contact);
	double slide = ob_norm(ob_contact_velocity(w, rows, contact));
	if (ob_shape_is(a->shape, OB_UNBOUNDED) || ob_shape_is(b->shape, OB_UNBOUNDED))
		slide = 0;
	double thin = ob_min(a->thickness, b->thickness), distance = (slide + .5 * thin * turn) * w->substep;
	const double share = ob_max(fast_share, ob_min(1, thin / distance)), allowed = w->tolerance / thin;
	// Error of a turn: half the thickness times the square of the angle, by which the surface leaves its tangent.
	// Error of a slide: at most the slide itself.
	const double max_turn = w->stretch * ob_coarser(w, max_motion, sqrt(2 * unnoticed * allowed)),
		     max_slide = w->stretch * ob_coarser(w, max_motion, allowed);
	return ob_min(max_turn * share / turn, max_slide * share * thin / slide);
}

static ob_vec3 axis_of(const ob_body *body, const ob_hull *part)
{
	ob_vec3 centre = { 0, 0, 0 };
	ob_mat3 r = body->r;
	if (ob_part_is_round(part))
		ob_part_enter(part, &centre, &r);
	return ob_column(&r, 2);
}

// Returns the rate (rad/s) at which the point where a rim touches goes round it. The rim that leans more counts, if there are two.
static double rate_round_rim(const ob_island_work *w, const ob_contact *contact)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES, row[2] = { contact->a, contact->b };
	const ob_vec3 n = ob_batch_vector(b->n, l),
		      turn = ob_sub(ob_row_angular(w->v[row[0]]), ob_row_angular(w->v[row[1]]));
	double least = 1, rate = 0;
	for (int side = 0; side < 2; side++) {
		const ob_body *body = &w->body[row[side]];
		const ob_vec3 axis = axis_of(body, contact->part[side]);
		const double along = ob_dot(n, axis);
		if (!ob_shape_is(ob_part_shape(body->shape, contact->part[side]), OB_RIMMED) || !(fabs(along) < least))
			continue;
		least = fabs(along);
		rate = fabs(ob_dot(n, turn) - along * ob_dot(axis, turn)) / (1 - along * along);
	}
	return rate;
}

// Returns an even part of what is left of the substep (s), in which a rim rolls on by a small angle: uneven ones make it hop.
static double even_part(const ob_island_work *w, const ob_contact *contact, double left)
{
	const double most = w->stretch * ob_coarser(w, max_round, 5 * max_round),
		     parts = ob_min(rate_round_rim(w, contact) / most, most_parts / w->substep) * left;
	return left / ob_max(1, ceil(parts));
}

// False if the geometry certainly lasts for h (s).
static bool may_outrun_geometry(const ob_island_work *w, const ob_contact *contact, double h)
{
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	return ob_contact_speed(w, contact) * h >
	       ob_min(1, w->stretch) * max_motion * ob_min(a->thickness, b->thickness);
}

// True if the contact touches now. A lane alone does not show it: without contact, it depends on when the narrow phase
// ran last.
static bool touches(const ob_island_work *w, const ob_contact *contact)
{
	return contact->lane != OB_NO_LANE && ob_contact_gap(w, contact) <= touching_gap * w->unit.length;
}

// False if the two bodies certainly do not meet within h (s).
static bool may_meet(const ob_island_work *w, const ob_contact *contact, double h)
{
	const double speed = ob_contact_speed(w, contact);
	if (contact->path + speed * (h + w->unpaced) <= contact->limit)
		return false;
	return contact->lane == OB_NO_LANE ||
	       ob_contact_gap(w, contact) <= touching_gap * w->unit.length + (speed + w->max_acceleration * h) * h;
}

static double partial_length(ob_solver *s, double left)
{
	ob_island_work *w = &s->island;
	double h = left;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		const bool leans = ob_contact_leans(contact), outruns = may_outrun_geometry(w, contact, h);
		if (!(leans || outruns) || !touches(w, contact))
			continue;
		h = ob_min(h, leans ? even_part(w, contact, left) : h);
		h = ob_min(h, outruns ? ob_max(w->h_min, geometry_lifetime(w, w->v, contact)) : h);
	}
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		if (!may_outrun_geometry(w, contact, h) || touches(w, contact) || !may_meet(w, contact, h))
			continue;
		ob_body_update_pose(w, contact->a);
		ob_body_update_pose(w, contact->b);
		h = ob_min(h, ob_max(ob_max(w->h_min, geometry_lifetime(w, w->v, contact)),
				     ob_narrowphase_time_of_impact(s, contact, h)));
	}
	h = ob_min(h, ob_max(w->h_min, ob_surfaces_reversal(s, h)));
	return left - h < .5 * h && left < 1.5 * w->h_min ? left : h;
}

// Sets the length of the partial substep (s), and scales the warm-start impulses in proportion.
static void set_length(ob_island_work *w, double h)
{
	double factor = h / w->h;
	w->h = h;
	if (factor == 1)
		return;
	for (uint32_t i = 0; i < w->batches; i++)
		for (int k = 0; k < OB_ROWS; k++)
			w->batch[i].impulse[k] *= factor;
}

void ob_adaptive_begin(ob_solver *s, double left)
{
	s->island.h_min = s->island.substep / max_partial_substeps;
	set_length(&s->island, partial_length(s, left));
}

bool ob_adaptive_shorten(ob_solver *s)
{
	ob_island_work *w = &s->island;
	double h = w->h;
	bool hit = false;
	for (uint32_t i = 0; i < w->batches; i++)
		hit |= w->batch[i].impact != 0;
	for (uint32_t i = 0; hit && i < w->contacts; i++)
		h = ob_min(h, geometry_lifetime(w, w->u, &w->contact[i]));
	h = ob_max(ob_max(h, w->h_min), w->last_impact); // not before the last impact made in it
	if (h > .6 * w->h)
		return false;
	ob_midpoint_undo(s);
	for (uint32_t i = 0; i < w->batches; i++)
		memcpy(w->batch[i].impulse, w->batch[i].impulse_start, sizeof w->batch[i].impulse);
	set_length(w, h);
	ob_bodies_warm_start(s);
	return true;
}
