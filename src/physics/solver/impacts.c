#include "solver/impacts.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "shape/shape.h"
#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/contacts.h"
#include "solver/instant.h"
#include "solver/machines.h"
#include "solver/narrowphase.h"
#include "solver/relative_speed.h"
#include "solver/surfaces.h"
#include "solver/touches.h"

static const double least_approach = 1e-6; // m/s
static const double aftershock_threshold = 1e-10; // m/s: slower approaches of bodies that were just hit are rounding
static const uint32_t max_aftershocks = 4; // maximum for a contact in a partial substep
static const double reach = 1e-3; // m: points this near at the instant are part of the contact's geometry
static const double min_curvature = 1e-8; // m
static const uint32_t max_rounds = 1000; // pairs that still approach then are left to the contact solver
static const uint32_t max_rebounds = 100; // maximum for a contact in a partial substep: later ones are plastic

// Thresholds of plastic hits; the contact solver takes approaches that are no hits
static const double touching = 1e-5; // m: points this near may be hit together with a hit beside them
static const double settling = 4; // substeps: an approach that drift builds up within these is no hit
static const double slow_share = .1; // share of gravity's change of velocity in a substep: a slower approach is no hit
static const double unnoticed = .2; // share of the tolerance: in a coarse run a smaller error of geometry is no hit

enum {
	MAX_NEWTON_STEPS = 20,
	MAX_TOUCHING = 128, // points connected with a plastic hit, if nothing external acts
	MAX_TOUCHING_LOADED = 4, // the same under external forces: larger heaps are left to the contact solver
	NONE = UINT32_MAX,
};

// Flag bits of seen[] while a round is chosen.
static const uint32_t in_group = UINT32_C(1) << 31, is_chosen = UINT32_C(1) << 30;

// ---- the instant of a contact

static double slow_of(const ob_island_work *w)
{
	return slow_share * w->max_acceleration * w->substep + least_approach * w->unit.speed;
}

// Returns the error, m, of a contact's rows within the partial substep, as its bodies turn or swing. If hits alone carry a
// contact, it includes their passing each other while they turn.
static double curvature(const ob_island_work *w, const ob_contact *contact)
{
	double speed = ob_norm(ob_contact_velocity(w, w->v, contact)), turn = 0, sum = 0, bend = 0;
	for (int side = 0; side < 2; side++) {
		const uint32_t row = side ? contact->b : contact->a;
		const ob_body *body = &w->body[row];
		if (body->surface)
			bend += 2 * ob_surface_bend(w, row);
		if ((!(body->inv_mass > 0) && !body->surface) || body->rolls ||
		    ob_shape_is(body->shape, OB_ISOTROPIC | OB_UNBOUNDED))
			continue;
		const double rate = ob_norm(ob_row_angular(w->v[row]));
		turn += rate;
		speed += body->radius * rate;
		sum += body->radius * rate * rate;
	}
	return .5 * w->h * w->h * (w->max_acceleration > 0 ? sum : sum + 2 * turn * speed) + bend;
}

// True for a plastic hit that a coarse run leaves to the contact solver: within the tolerance, its geometry at its
// instant is that of the partial substep's start. Hits are needed in any case where nothing presses bodies together.
static bool is_unnoticed(const ob_island_work *w, const ob_contact *contact)
{
	return w->coarseness > 1 && w->max_acceleration > 0 && curvature(w, contact) <= unnoticed * w->tolerance;
}

// Returns a bit for each of the contact's points that may hit. A point that carries a load where something presses
// bodies together is held, and no hit, unless one of its bodies has just been hit.
static unsigned may_hit(const ob_island_work *w, const ob_contact *contact)
{
	enum { ALL = (1 << OB_POINTS) - 1 };
	const ob_body *a = &w->body[contact->a], *b = &w->body[contact->b];
	unsigned mask = 0;
	if (contact->lane == OB_NO_LANE)
		return 0;
	if (contact->e > 0)
		return ALL;
	if (!w->plastic || contact->left_to_solver || a->speed + b->speed + w->max_acceleration * w->h <= slow_of(w) ||
	    is_unnoticed(w, contact))
		return 0;
	if (w->max_acceleration == 0 || a->hit > 0 || b->hit > 0)
		return ALL;
	const ob_batch *batch = &w->batch[contact->lane / OB_LANES];
	for (uint32_t j = 0; j < contact->points; j++)
		mask |= (unsigned)!(batch->impulse[j][contact->lane % OB_LANES] > 0) << j;
	return mask;
}

// Returns the speed, m/s, below which approaches are left to the contact solver. It is lower if both bodies have just
// been hit: so an impact's motion ends the same for any order of its parts.
static double threshold_of(const ob_island_work *w, const ob_contact *contact)
{
	const double a = w->body[contact->a].hit, b = w->body[contact->b].hit;
	if (contact->e == 0)
		return slow_of(w);
	if (a > 0 && b > 0 && contact->rebounds < max_aftershocks &&
	    fabs(a - b) * ob_contact_speed(w, contact) <= OB_IMPACT_SIMULTANEOUS * w->unit.length)
		return aftershock_threshold * w->unit.speed;
	return 4 * w->max_acceleration * w->substep + least_approach * w->unit.speed;
}

// Returns the rate, m/s, at which a point opens at an instant.
static double rate_of(const ob_body_at *a, const ob_body_at *b, const ob_manifold *m, int j)
{
	ob_vec3 va = ob_add(a->v, ob_cross(a->w, ob_sub(m->at[j], a->p)));
	ob_vec3 vb = ob_add(b->v, ob_cross(b->w, ob_sub(m->at[j], b->p)));
	return ob_dot(m->normal, ob_sub(va, vb));
}

static void find_between(ob_solver *s, const ob_contact *contact, const ob_body_at *a, const ob_body_at *b,
			 ob_manifold *m)
{
	const ob_island_work *w = &s->island;
	ob_placed pa, pb;
	ob_narrowphase_place(s, contact->a, contact->part[0], a->p, &a->r, a->v, a->w, &pa);
	ob_narrowphase_place(s, contact->b, contact->part[1], b->p, &b->r, b->v, b->w, &pb);
	const double closing = ob_contact_speed(w, contact);
	const double thin = ob_min(w->body[contact->a].thickness, w->body[contact->b].thickness);
	const ob_manifold_finder finder = ob_narrowphase_finder(s);
	s->counters.narrowphase_tests++;
	m->disc_radius = 0;
	m->valid_path = INFINITY;
	finder.find(finder.with, &pa, &pb, ob_min(reach * w->unit.length + 1.5 * closing * w->h, .5 * thin), m);
}

static void find_at(ob_solver *s, const ob_contact *contact, double t, ob_body_at *a, ob_body_at *b, ob_manifold *m)
{
	enum { WORK_OF_FLIGHTS = 32 };
	ob_budget_note(s, WORK_OF_FLIGHTS);
	*a = ob_body_at_time(&s->island, contact->a, t);
	*b = ob_body_at_time(&s->island, contact->b, t);
	find_between(s, contact, a, b, m);
}

// Returns the change, m/s, of a point's rate by the drift of the two bodies within the partial substep.
static double gain_of(const ob_island_work *w, const ob_contact *contact, const ob_body_at *a, const ob_body_at *b,
		      const ob_manifold *m, int j)
{
	const double *fa = w->drift[contact->a], *fb = w->drift[contact->b];
	ob_vec3 va = ob_add(ob_row_linear(fa), ob_cross(ob_row_angular(fa), ob_sub(m->at[j], a->p)));
	ob_vec3 vb = ob_add(ob_row_linear(fb), ob_cross(ob_row_angular(fb), ob_sub(m->at[j], b->p)));
	return ob_dot(m->normal, ob_sub(va, vb));
}

// True if the point at an instant may hit: its nearest point at the partial substep's start decides.
static bool point_may_hit(const ob_contact *contact, unsigned mask, const ob_body_at *a, const ob_manifold *m, int j)
{
	uint32_t nearest = 0;
	double least = INFINITY;
	for (uint32_t k = 0; k < contact->points; k++) {
		double apart = ob_norm2(ob_sub(ob_sub(m->at[j], a->p), contact->arm_a[k]));
		if (apart < least)
			least = apart, nearest = k;
	}
	return mask >> nearest & 1;
}

// Returns the time, s, from an instant on until the first approaching point closes; infinity: none does.
static double until_closing(const ob_island_work *w, const ob_impact_instant *i, const ob_body_at *a,
			    const ob_body_at *b, double *approach)
{
	const ob_contact *contact = &w->contact[i->contact];
	const ob_manifold *m = &i->m;
	const double threshold = threshold_of(w, contact);
	const unsigned mask = may_hit(w, contact);
	double first = INFINITY;
	for (int j = 0; j < m->points; j++) {
		double rate = rate_of(a, b, m, j), least = threshold;
		if (contact->e == 0)
			least += settling * w->substep / w->h * ob_max(0, -gain_of(w, contact, a, b, m, j));
		if (!(rate < -least) || !point_may_hit(contact, mask, a, m, j))
			continue;
		if (-m->gap[j] / rate < first)
			first = -m->gap[j] / rate, *approach = -rate;
	}
	return first;
}

// Refines an instant that the rows have given, by Newton's method on the gap of the shapes. false: they do not meet in
// the partial substep; then the contact's geometry is that of the last instant to which it was followed. The gap of an
// almost level rim is exact to 1e-11 m only: the iteration ends when a step is no shorter than the one before.
static bool refine_instant(ob_solver *s, ob_impact_instant *i, double earliest, ob_body_at *a, ob_body_at *b)
{
	const ob_island_work *w = &s->island;
	const ob_contact *contact = &w->contact[i->contact];
	const double smaller = ob_min(w->body[contact->a].radius, w->body[contact->b].radius);
	const double at_once = OB_IMPACT_SIMULTANEOUS * w->unit.length;
	double last = INFINITY; // m
	i->time = ob_max(i->time, earliest);
	for (int k = 0; k < MAX_NEWTON_STEPS; k++) {
		find_at(s, contact, i->time, a, b, &i->m);
		double more = until_closing(w, i, a, b, &i->approach);
		if (isinf(more))
			return false;
		const double rounding = 8 * DBL_EPSILON * (ob_norm(a->p) + ob_norm(b->p) + smaller);
		const double off = fabs(more) * i->approach;
		if (off <= rounding || (off <= at_once && off >= last) || (i->time <= earliest && more <= 0))
			return true;
		last = off;
		if (i->time >= w->h && more > 0)
			return false;
		i->time = ob_max(earliest, ob_min(w->h, i->time + more));
	}
	return false;
}

// Raises a contact's gaps so that its rows do not close, where nothing external acts and hits do all the work. Bodies
// were set back to the partial substep's start; an approach of rows there is due to the turn of the geometry alone.
static void keep_open(const ob_island_work *w, const ob_contact *contact)
{
	ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES, ia = contact->a, ib = contact->b;
	for (uint32_t j = 0; j < contact->points; j++)
		b->gap[j][l] = ob_max(b->gap[j][l], -w->h * ob_batch_opening(b, l, j, w->v[ia], w->v[ib]) -
							    ob_batch_opening(b, l, j, w->d[ia], w->d[ib]));
}

// Extrapolates the contact's geometry at an instant back to the partial substep's start, along its bodies' flights.
static void take_geometry(ob_solver *s, ob_impact_instant *i, const ob_body_at *a, const ob_body_at *b)
{
	ob_island_work *w = &s->island;
	ob_contact *contact = &w->contact[i->contact];
	const double t = i->time;
	ob_manifold m = i->m;
	for (int j = 0; j < m.points; j++)
		m.gap[j] += -t * rate_of(a, b, &m, j) + .5 * t * t / w->h * gain_of(w, contact, a, b, &m, j);
	if (m.points)
		ob_contact_set_geometry(s, contact, &m, a->p, b->p);
	if (m.points && w->plastic && w->max_acceleration == 0)
		keep_open(w, contact);
}

static double later(double a, double b)
{
	return a > b ? a : b;
}

// Finds the contact's next impact, if there is one, and its instant and geometry then.
static void look_ahead(ob_solver *s, uint32_t contact)
{
	ob_island_work *w = &s->island;
	const ob_contact *c = &w->contact[contact];
	const unsigned mask = may_hit(w, c);
	w->contact[contact].misses = false;
	if (!mask)
		return;
	enum { WORK = 4 };
	ob_budget_note(s, WORK);
	const double slack = curvature(w, c), threshold = threshold_of(w, c);
	ob_impact in = { .h = w->h,
			 .threshold = threshold,
			 .settling = c->e > 0 ? 0 : settling * w->substep,
			 .gain = 2 * OB_SMOOTH_ACCELERATION * w->max_acceleration * w->h,
			 .points = mask };
	const ob_impact_rows at = { w->v, w->drift, w->d };
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	const int l = c->lane % OB_LANES;
	if (slack > min_curvature * w->unit.length) {
		in.slack = slack;
		in.threshold = threshold - 2 * slack / w->h;
	}
	const double first = ob_impact_time(b, l, &in, &at);
	if (isinf(first)) {
		w->contact[contact].misses = true;
		return;
	}
	ob_body_update_pose(w, c->a);
	ob_body_update_pose(w, c->b);
	ob_impact_instant i = { .contact = contact, .time = first, .joined = true };
	ob_body_at body_a, body_b;
	if (refine_instant(s, &i, later(w->body[c->a].hit, w->body[c->b].hit), &body_a, &body_b)) {
		w->impacts.pending[w->impacts.count++] = i;
	} else if (c->e > 0 || w->max_acceleration == 0) {
		in.slack = 0;
		in.threshold = threshold;
		if (ob_impact_time(b, l, &in, &at) <= w->h)
			take_geometry(s, &i, &body_a, &body_b);
	} else if (i.time >= w->h) {
		w->contact[contact].misses = true;
	}
}

// ---- sets

static bool moves(const ob_island_work *w, uint32_t row)
{
	return row >= 1 && row <= w->bodies;
}

static bool is_plastic(const ob_contact *contact)
{
	return contact->e == 0;
}

// Returns the instant, s, of the first pending hit with restitution, or without.
static double first_pending(const ob_island_work *w, bool plastic)
{
	double first = INFINITY;
	for (uint32_t k = 0; k < w->impacts.count; k++)
		if (is_plastic(&w->contact[w->impacts.pending[k].contact]) == plastic)
			first = ob_min(first, w->impacts.pending[k].time);
	return first;
}

static bool at_once_with(const ob_island_work *w, const ob_impact_instant *i, double time)
{
	return (i->time - time) * i->approach <= OB_IMPACT_SIMULTANEOUS * w->unit.length;
}

// Moves those pending impacts to the front that come before any other of their bodies; returns their number. Hits at
// the same time that share bodies get the same root. A plastic hit may spread to bodies that have hits of their own: it
// waits until it is the first of all.
static uint32_t select_earliest(ob_island_work *w)
{
	ob_impacts *x = &w->impacts;
	const double plastic = first_pending(w, true), elastic = first_pending(w, false);
	uint32_t selected = 0;
	for (uint32_t k = 0; k < x->count; k++)
		for (int side = 0; side < 2; side++) {
			const ob_contact *c = &w->contact[x->pending[k].contact];
			x->first[x->machine[side ? c->b : c->a]] = INFINITY;
		}
	for (uint32_t k = 0; k < x->count; k++)
		for (int side = 0; side < 2; side++) {
			const ob_contact *c = &w->contact[x->pending[k].contact];
			double *first = &x->first[x->machine[side ? c->b : c->a]];
			*first = ob_min(*first, x->pending[k].time);
		}
	for (uint32_t k = 0; k < x->count; k++) {
		const ob_impact_instant i = x->pending[k];
		const ob_contact *c = &w->contact[i.contact];
		double first = ob_min(plastic, moves(w, c->a) ? x->first[x->machine[c->a]] : INFINITY);
		first = ob_min(first, moves(w, c->b) ? x->first[x->machine[c->b]] : INFINITY);
		if (is_plastic(c))
			first = ob_min(first, elastic);
		if (!at_once_with(w, &i, first))
			continue;
		x->pending[k] = x->pending[selected];
		x->pending[selected++] = i;
		if (moves(w, c->a) && moves(w, c->b))
			ob_machines_join(x, c->a, c->b);
	}
	return selected;
}

// ---- plastic sets: plastic contacts that touch the hit bodies are hit with them

// Returns the number of a contact's points that, by its rows, are almost closed at an instant.
static uint32_t touching_points(const ob_island_work *w, const ob_contact *contact, double t)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES, ia = contact->a, ib = contact->b;
	const double near = touching * w->unit.length + curvature(w, contact);
	uint32_t n = 0;
	for (uint32_t j = 0; j < contact->points; j++)
		n += b->gap[j][l] + ob_batch_opening(b, l, j, w->d[ia], w->d[ib]) +
			     t * ob_batch_opening(b, l, j, w->v[ia], w->v[ib]) +
			     .5 * t * t / w->h * ob_batch_opening(b, l, j, w->drift[ia], w->drift[ib]) <=
		     near;
	return n;
}

typedef struct touching_group {
	uint32_t contacts, points, contact[MAX_TOUCHING + 1];
} touching_group;

// Finds all plastic contacts connected with one through moving bodies. false: too many points.
static bool find_group(ob_island_work *w, uint32_t first, double t, touching_group *g)
{
	ob_impacts *x = &w->impacts;
	const uint32_t most = w->max_acceleration > 0 ? MAX_TOUCHING_LOADED : MAX_TOUCHING;
	g->contacts = 1;
	g->points = touching_points(w, &w->contact[first], t);
	g->contact[0] = first;
	x->seen[first] |= in_group;
	for (uint32_t k = 0; k < g->contacts && g->points <= most; k++)
		for (int side = 0; side < 2 && g->points <= most; side++) {
			const ob_contact *c = &w->contact[g->contact[k]];
			const uint32_t row = side ? c->b : c->a;
			const ob_body *body = &w->body[row];
			for (uint32_t j = 0; moves(w, row) && j < body->adjacent && g->points <= most; j++) {
				const uint32_t i = w->adjacency[body->first_adjacent + j];
				const ob_contact *other = &w->contact[i];
				uint32_t n = 0;
				if (!(x->seen[i] & in_group) && is_plastic(other) && other->lane != OB_NO_LANE)
					n = touching_points(w, other, t);
				g->points += n;
				if (!n || g->points > most)
					continue;
				x->seen[i] |= in_group;
				g->contact[g->contacts++] = i;
			}
		}
	for (uint32_t k = 0; k < g->contacts; k++)
		x->seen[g->contact[k]] &= ~in_group;
	return g->points <= most;
}

// Adds a contact to the first "selected" pending impacts, unless it is there already. Returns their new number.
static uint32_t select_touching(ob_solver *s, uint32_t contact, double t, uint32_t selected)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	const ob_contact *c = &w->contact[contact];
	ob_impact_instant i = { .contact = contact, .time = t };
	ob_body_at a, b;
	bool touches = false;
	if (x->seen[contact] & is_chosen)
		return selected;
	ob_body_update_pose(w, c->a);
	ob_body_update_pose(w, c->b);
	find_at(s, c, t, &a, &b, &i.m);
	for (int j = 0; j < i.m.points; j++)
		touches |= i.m.gap[j] <= touching * w->unit.length;
	if (!touches)
		return selected;
	x->seen[contact] |= is_chosen;
	x->pending[x->count++] = x->pending[selected];
	x->pending[selected] = i;
	if (moves(w, c->a) && moves(w, c->b))
		ob_machines_join(x, c->a, c->b);
	return selected + 1;
}

// Removes a pending impact from the first "selected"; the contact solver takes its contact.
static uint32_t leave_to_solver(ob_island_work *w, uint32_t k, uint32_t selected)
{
	ob_impacts *x = &w->impacts;
	w->contact[x->pending[k].contact].left_to_solver = true;
	x->seen[x->pending[k].contact] = 0;
	x->pending[k] = x->pending[--selected];
	x->pending[selected] = x->pending[--x->count];
	return selected;
}

// Adds the contacts that touch their bodies to the first "selected" pending impacts. Returns their new number.
static uint32_t join_touching(ob_solver *s, uint32_t selected)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	const uint32_t hits = selected;
	touching_group g;
	for (uint32_t k = 0; k < hits; k++)
		x->seen[x->pending[k].contact] |= is_chosen;
	for (uint32_t k = 0; k < selected && k < hits;) {
		const ob_impact_instant i = x->pending[k];
		if (!is_plastic(&w->contact[i.contact])) {
			k++;
		} else if (find_group(w, i.contact, i.time, &g)) {
			for (uint32_t j = 0; j < g.contacts; j++)
				selected = select_touching(s, g.contact[j], i.time, selected);
			k++;
		} else {
			selected = leave_to_solver(w, k, selected);
		}
	}
	for (uint32_t k = 0; k < selected; k++)
		x->seen[x->pending[k].contact] = 0;
	return selected;
}

static bool in_set(const ob_impacts *x, uint32_t row)
{
	return x->slot[row] < x->bodies && x->row[x->slot[row]] == row;
}

static uint32_t body_of_set(ob_solver *s, ob_impacts *x, uint32_t row, double t)
{
	ob_island_work *w = &s->island;
	if (in_set(x, row))
		return x->slot[row];
	const uint32_t i = x->slot[row] = x->bodies++;
	const ob_body *body = &w->body[row];
	const ob_body_at at = x->at[i] = ob_body_at_time(w, row, t);
	x->row[i] = row;
	const ob_vec3 v = body->surface ? ob_add(at.v, ob_surface_velocity(w, row)) : at.v;
	x->body[i] = (ob_impact_body){ .inv_mass = body->inv_mass, .v = v, .w = at.w };
	if (body->inv_mass > 0)
		ob_inverse_inertia(body->inertia, &at.r, x->body[i].inv_inertia);
	return i;
}

// Returns the level, m, of the plane in which convex bodies touch, along its normal from "centre". Points that
// penetrate, to different depths, define no such plane, and could not all leave as restitution demands: a body that
// tilts moves them towards each other. With plastic hits all can stop.
static double level_of(const ob_manifold *m, double near, ob_vec3 centre)
{
	double sum = 0;
	int points = 0;
	for (int j = 0; j < m->points; j++)
		if (m->gap[j] <= near)
			sum += ob_dot(m->normal, ob_sub(m->at[j], centre)), points++;
	return points ? sum / points : 0;
}

// Notes how far the next corner that comes down is from a hit, before its impulses: a body that is off by more may hit with that one
// first. Points of round shapes follow each other smoothly; a pivot does not approach.
static void note_next_point(ob_island_work *w, const ob_impact_instant *i, const ob_body_at *a, const ob_body_at *b)
{
	ob_contact *c = &w->contact[i->contact];
	for (int side = 0; side < 2; side++)
		if (!ob_shape_is(w->body[side ? c->b : c->a].shape, OB_CORNERED | OB_UNBOUNDED))
			return;
	for (int j = 0; j < i->m.points; j++)
		if (i->m.gap[j] > OB_IMPACT_SIMULTANEOUS * w->unit.length && rate_of(a, b, &i->m, j) < -slow_of(w))
			c->next_point = ob_min(c->next_point, i->m.gap[j]);
}

static void add_points(ob_solver *s, ob_impact_instant *i, double t)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	const ob_contact *c = &w->contact[i->contact];
	const uint32_t a = body_of_set(s, x, c->a, t), b = body_of_set(s, x, c->b, t);
	const ob_vec3 pa = x->at[a].p, pb = x->at[b].p;
	const double near = (is_plastic(c) ? touching : OB_IMPACT_SIMULTANEOUS) * w->unit.length;
	const double level = level_of(&i->m, near, pa);
	note_next_point(w, i, &x->at[a], &x->at[b]);
	i->first_point = x->points;
	for (int j = 0; j < i->m.points; j++) {
		const ob_vec3 arm = ob_sub(i->m.at[j], pa);
		const double off = is_plastic(c) ? 0 : level - ob_dot(i->m.normal, arm);
		const ob_vec3 at = ob_madd(i->m.at[j], off, i->m.normal);
		if (i->m.gap[j] > near)
			continue;
		x->point[x->points] = (ob_impact_point){ .a = a,
							 .b = b,
							 .normal = i->m.normal,
							 .arm_a = ob_sub(at, pa),
							 .arm_b = ob_sub(at, pb),
							 .mu = c->mu,
							 .e = c->rebounds < max_rebounds ? c->e : 0 };
		x->points += is_plastic(c) || ob_impact_opening(x->body, &x->point[x->points]) < 0;
	}
	i->set_points = x->points - i->first_point;
}

// Adds all bodies of the machines that are hit. Returns false if there are none.
static bool add_machines(ob_solver *s, double t)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	const uint32_t hit = x->bodies;
	bool any = false;
	if (!w->elastic || !w->joints.count)
		return false;
	for (uint32_t i = 0; i < hit; i++)
		if (moves(w, x->row[i]) && w->body[x->row[i]].joints) {
			(void)body_of_set(s, x, x->machine[x->row[i]], t);
			any = true;
		}
	for (uint32_t row = 1; any && row <= w->bodies; row++)
		if (in_set(x, x->machine[row]))
			(void)body_of_set(s, x, row, t);
	return any;
}

// Returns the body at the instant t, as the impact leaves it.
static ob_body_at body_after(const ob_island_work *w, uint32_t row, double t)
{
	const ob_impacts *x = &w->impacts;
	if (!in_set(x, row))
		return ob_body_at_time(w, row, t);
	ob_body_at at = x->at[x->slot[row]];
	at.v = x->body[x->slot[row]].v;
	at.w = x->body[x->slot[row]].w;
	return at;
}

// Returns the body a time h (s) after the impact at the instant t.
static ob_body_at body_later(const ob_island_work *w, uint32_t row, double t, double h)
{
	if (w->body[row].surface)
		return ob_body_at_time(w, row, t + h);
	ob_body_at x = body_after(w, row, t);
	ob_fly(w, row, h, &x);
	return x;
}

// Sets the speeds at which points leave. Without a force that presses bodies together, they hit again and again while
// they touch, as turning closes a contact that a plastic hit has stopped. So a point leaves fast enough to come back
// after a partial substep, and no faster than it has come: then the hit does no work, and no penetration is left to be
// pushed apart. Returns true if any point does. before: velocities
static bool set_hops(ob_solver *s, uint32_t chain, double t, const ob_impact_body *before)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	bool any = false;
	for (uint32_t k = chain; k != NONE; k = x->next[k]) {
		const ob_impact_instant *i = &x->pending[k];
		const ob_contact *c = &w->contact[i->contact];
		ob_manifold m;
		double least = 0;
		if (!i->joined)
			continue;
		const ob_body_at at_a = body_later(w, c->a, t, w->h), at_b = body_later(w, c->b, t, w->h);
		find_between(s, c, &at_a, &at_b, &m);
		for (int j = 0; j < m.points; j++)
			least = ob_min(least, m.gap[j]);
		for (uint32_t j = i->first_point; j < i->first_point + i->set_points; j++) {
			const double approach = -ob_impact_opening(before, &x->point[j]);
			const double e = approach > 0 ? ob_min(1, -least / w->h / approach) : 0;
			any |= e > x->point[j].e;
			x->point[j].e = ob_max(e, x->point[j].e);
		}
	}
	return any;
}

// Sets a body back from its state x after an impact to the partial substep's start.
static void set_back(ob_solver *s, uint32_t row, ob_body_at x, double t)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	double *v = w->v[row], *d = w->d[row];
	ob_fly(w, row, -t, &x);
	const double change =
		ob_norm(ob_sub(x.v, ob_row_linear(v))) + body->radius * ob_norm(ob_sub(x.w, ob_row_angular(v)));
	for (uint32_t k = 0; k < body->adjacent; k++) // until t it went at another speed
		w->contact[w->adjacency[body->first_adjacent + k]].path += t * change;
	ob_vec3 shift = ob_sub(x.p, body->p), turn = ob_turn_between(body->q, x.q);
	memcpy(d, (double[8]){ shift.x, shift.y, shift.z, turn.x, turn.y, turn.z }, sizeof *w->d);
	ob_body_update_pose(w, row);
	memcpy(v, (double[8]){ x.v.x, x.v.y, x.v.z, x.w.x, x.w.y, x.w.z }, sizeof *w->v);
	body->hit = ob_max(t, DBL_MIN);
}

static void velocity_after(const ob_island_work *w, uint32_t row, double t, double *out)
{
	const ob_body_at x = body_after(w, row, t);
	memcpy(out, (double[6]){ x.v.x, x.v.y, x.v.z, x.w.x, x.w.y, x.w.z }, 6 * sizeof *out);
}

// True if a load that has acted until the impact has changed the velocity of the other body, but not yet this one's. A
// body that is set back has had its share by its drift, if that includes loads.
static bool lacks_load(const ob_island_work *w, uint32_t row, uint32_t other)
{
	const ob_impacts *x = &w->impacts;
	const bool by_drift = in_set(x, row) && (w->body[row].loaded || !in_set(x, other));
	return w->body[other].loaded && !by_drift;
}

// Adds a share of a change to a body's velocity: at the partial substep's start, or after the impact.
static void give_velocity(ob_island_work *w, uint32_t row, double share, const double *change)
{
	ob_impacts *x = &w->impacts;
	double *v = w->v[row];
	if (in_set(x, row)) {
		ob_impact_body *body = &x->body[x->slot[row]];
		body->v = ob_madd(body->v, share, ob_row_linear(change));
		body->w = ob_madd(body->w, share, ob_row_angular(change));
		return;
	}
	for (int i = 0; i < 6; i++)
		v[i] += share * change[i];
}

// Ends the load of a contact that the impact opens: from the instant t on the drift of the set's bodies excludes it.
static void end_load(ob_island_work *w, const ob_contact *c, double t)
{
	ob_batch *b = &w->batch[c->lane / OB_LANES];
	const uint32_t l = c->lane % OB_LANES, side[2] = { c->a, c->b };
	lanes load[OB_ROWS] = { 0 };
	double rows[2][6], sum = 0, ends = 0;
	for (int k = 0; k < 2; k++)
		velocity_after(w, side[k], t, rows[k]);
	for (uint32_t j = 0; j < c->points; j++) {
		const double pressed = b->impulse[j][l];
		sum += pressed;
		if (!(pressed > 0) || !(ob_batch_opening(b, l, j, rows[0], rows[1]) > slow_of(w)))
			continue;
		ends += pressed;
		load[j][l] = pressed;
		b->impulse[j][l] = 0;
	}
	if (!(ends > 0))
		return;
	for (int j = OB_POINTS; j < OB_ROWS; j++) {
		load[j][l] = b->impulse[j][l] * ends / sum;
		b->impulse[j][l] -= load[j][l];
	}
	ob_batch_apply_impulses(b, load, w->delta);
	for (int k = 0; k < 2; k++) {
		double *brought = w->delta[side[k]], *drift = w->drift[side[k]];
		for (int i = 0; i < 6 && moves(w, side[k]); i++)
			drift[i] -= w->body[side[k]].loaded ? brought[i] : 0;
		if (moves(w, side[k]) && lacks_load(w, side[k], side[1 - k]))
			give_velocity(w, side[k], t / w->h, brought);
		w->body[side[k]].hit = moves(w, side[k]) ? ob_max(t, DBL_MIN) : 0;
	}
	for (int k = 0; k < 2; k++)
		memset(w->delta[side[k]], 0, sizeof *w->delta);
}

static void end_loads(ob_island_work *w, uint32_t row, double t)
{
	const ob_body *body = &w->body[row];
	for (uint32_t k = 0; moves(w, row) && k < body->adjacent; k++) {
		const ob_contact *c = &w->contact[w->adjacency[body->first_adjacent + k]];
		if (c->lane != OB_NO_LANE)
			end_load(w, c, t);
	}
}

// Leaves a set that has grown too large to the contact solver. false: it has restitution.
static bool leave_plastic(ob_solver *s, uint32_t chain)
{
	ob_island_work *w = &s->island;
	const ob_impacts *x = &w->impacts;
	for (uint32_t k = chain; k != NONE; k = x->next[k])
		if (!is_plastic(&w->contact[x->pending[k].contact]))
			return false;
	for (uint32_t k = chain; k != NONE; k = x->next[k])
		w->contact[x->pending[k].contact].left_to_solver = true;
	return true;
}

static bool is_over(void *sim, uint64_t work)
{
	ob_budget_note(sim, work);
	return ob_budget_spent(sim);
}

static void solve_points(ob_solver *s)
{
	ob_impacts *x = &s->island.impacts;
	const ob_impact_payer payer = { is_over, s };
	const ob_impact_links links = { ob_machines_share, s };
	ob_impact_solve(x->body, x->bodies, x->point, x->points, x->linked ? &links : NULL, &payer);
}

// Solves the impact of those contacts from "chain" on that have joined it. false: it is left to the contact solver.
static bool solve_joined(ob_solver *s, uint32_t chain, double t)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	x->bodies = x->points = 0;
	x->instant = t, x->found = false;
	for (uint32_t k = chain; k != NONE; k = x->next[k])
		if (x->pending[k].joined)
			add_points(s, &x->pending[k], t);
	x->linked = add_machines(s, t);
	if (x->points > OB_IMPACT_MOST_POINTS && leave_plastic(s, chain))
		return false;
	memcpy(x->before, x->body, x->bodies * sizeof *x->body);
	solve_points(s);
	return true;
}

// Joins contacts that touch hit bodies and are closed by the hit. true: there were some.
static bool join_violated(ob_solver *s, uint32_t chain, double t)
{
	const ob_island_work *w = &s->island;
	ob_impacts *x = &s->island.impacts;
	bool any = false;
	for (uint32_t k = chain; k != NONE; k = x->next[k]) {
		ob_impact_instant *i = &x->pending[k];
		const ob_contact *c = &w->contact[i->contact];
		if (i->joined || (!in_set(x, c->a) && !in_set(x, c->b)))
			continue;
		const ob_body_at a = body_after(w, c->a, t), b = body_after(w, c->b, t);
		for (int j = 0; j < i->m.points && !i->joined; j++)
			i->joined = i->m.gap[j] <= touching * w->unit.length &&
				    rate_of(&a, &b, &i->m, j) < -aftershock_threshold * w->unit.speed;
		any |= i->joined;
	}
	return any;
}

// Solves one impact of all contacts from "chain" on, which hit at the same instant.
static void solve_set(ob_solver *s, uint32_t chain)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	double t = INFINITY;
	for (uint32_t k = chain; k != NONE; k = x->next[k])
		t = ob_min(t, x->pending[k].time);
	do {
		if (!solve_joined(s, chain, t))
			return;
	} while (join_violated(s, chain, t));
	if (w->max_acceleration == 0 && set_hops(s, chain, t, x->before)) {
		memcpy(x->body, x->before, x->bodies * sizeof *x->body);
		solve_points(s);
	}
	ob_machines_note_loads(w);
	for (uint32_t i = 0; i < x->bodies; i++)
		end_loads(w, x->row[i], t);
	for (uint32_t i = 0; i < x->bodies; i++)
		if (moves(w, x->row[i])) {
			x->at[i].v = x->body[i].v, x->at[i].w = x->body[i].w;
			set_back(s, x->row[i], x->at[i], t);
			x->changed[x->changes++] = x->row[i];
		}
	for (uint32_t k = chain; k != NONE; k = x->next[k]) {
		ob_impact_instant *i = &x->pending[k];
		if (!i->joined)
			continue;
		w->contact[i->contact].rebounds++;
		w->contact[i->contact].hit = true;
		i->time = t;
		ob_touches_note_impact(s, i);
		take_geometry(s, i, &x->at[x->slot[w->contact[i->contact].a]],
			      &x->at[x->slot[w->contact[i->contact].b]]);
		s->counters.impacts++;
	}
	w->last_impact = ob_max(w->last_impact, t);
}

// Solves the first "selected" of the pending impacts, set by set.
static void solve_selected(ob_solver *s, uint32_t selected)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	uint32_t sets = 0;
	for (uint32_t k = 0; k < selected; k++) {
		const ob_contact *c = &w->contact[x->pending[k].contact];
		x->head[ob_machines_set(x, moves(w, c->a) ? c->a : c->b)] = NONE;
	}
	for (uint32_t k = selected; k-- > 0;) {
		const ob_contact *c = &w->contact[x->pending[k].contact];
		uint32_t root = ob_machines_set(x, moves(w, c->a) ? c->a : c->b);
		if (x->head[root] == NONE)
			x->set[sets++] = root;
		x->next[k] = x->head[root];
		x->head[root] = k;
	}
	for (uint32_t i = 0; i < sets; i++)
		solve_set(s, x->head[x->set[i]]);
	for (uint32_t k = 0; k < selected; k++) {
		const ob_contact *c = &w->contact[x->pending[k].contact];
		x->root[x->machine[c->a]] = x->machine[c->a];
		x->root[x->machine[c->b]] = x->machine[c->b];
	}
}

// ---- rounds

static void reserve(ob_island_work *w)
{
	ob_impacts *x = &w->impacts;
	if (w->contacts > x->contacts_max) {
		x->contacts_max = w->contacts + w->contacts / 2;
		x->pending = ob_reallocate(x->pending, 2 * x->contacts_max * sizeof *x->pending);
		x->next = ob_reallocate(x->next, x->contacts_max * sizeof *x->next);
		x->seen = ob_reallocate(x->seen, x->contacts_max * sizeof *x->seen);
		x->set = ob_reallocate(x->set, x->contacts_max * sizeof *x->set);
		x->point = ob_reallocate(x->point, (OB_PAIR_POINTS * x->contacts_max + 1) * sizeof *x->point);
	}
	if (w->rows > x->rows_max) {
		x->rows_max = w->rows + w->rows / 2;
		x->machine = ob_reallocate(x->machine, x->rows_max * sizeof *x->machine);
		x->root = ob_reallocate(x->root, x->rows_max * sizeof *x->root);
		x->first = ob_reallocate(x->first, x->rows_max * sizeof *x->first);
		x->slot = ob_reallocate(x->slot, x->rows_max * sizeof *x->slot);
		x->head = ob_reallocate(x->head, x->rows_max * sizeof *x->head);
		x->row = ob_reallocate(x->row, x->rows_max * sizeof *x->row);
		x->changed = ob_reallocate(x->changed, x->rows_max * sizeof *x->changed);
		x->at = ob_reallocate(x->at, x->rows_max * sizeof *x->at);
		x->body = ob_reallocate(x->body, x->rows_max * sizeof *x->body);
		x->before = ob_reallocate(x->before, x->rows_max * sizeof *x->before);
	}
}

// Looks for new impacts of bodies that were hit, after a round.
static void look_again(ob_solver *s, uint32_t round, uint32_t selected)
{
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	uint32_t kept = 0;
	for (uint32_t k = 0; k < x->changes; k++)
		for (uint32_t j = 0; j < w->body[x->changed[k]].adjacent; j++)
			x->seen[w->adjacency[w->body[x->changed[k]].first_adjacent + j]] = round;
	for (uint32_t k = selected; k < x->count; k++)
		if (x->seen[x->pending[k].contact] != round)
			x->pending[kept++] = x->pending[k];
	x->count = kept;
	for (uint32_t k = 0; k < x->changes; k++)
		for (uint32_t j = 0; j < w->body[x->changed[k]].adjacent; j++) {
			const uint32_t i = w->adjacency[w->body[x->changed[k]].first_adjacent + j];
			if (x->seen[i] != round)
				continue;
			x->seen[i] = 0;
			look_ahead(s, i);
		}
	x->changes = 0;
}

// Looks for impacts of all contacts, or of those of hit bodies alone: the others have not changed.
static void look_at_all(ob_solver *s, bool others)
{
	ob_island_work *w = &s->island;
	w->impacts.count = w->impacts.changes = 0;
	memset(w->impacts.seen, 0, w->contacts * sizeof *w->impacts.seen);
	for (uint32_t i = 0; i < w->contacts; i++)
		if (others || ob_contact_was_hit(w, &w->contact[i]))
			look_ahead(s, i);
}

double ob_impacts_slack(const ob_solver *s, const ob_contact *contact, uint32_t point)
{
	const double share = .5, tolerance = s->settings->tolerance;
	const ob_island_work *w = &s->island;
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES, ia = contact->a, ib = contact->b;
	if (!contact->misses || b->impulse[point][l] > 0)
		return 0;
	const double gain = ob_batch_opening(b, l, point, w->drift[ia], w->drift[ib]);
	const double rate = ob_batch_opening(b, l, point, w->v[ia], w->v[ib]) + gain;
	if (!(rate < -(threshold_of(w, contact) + settling * w->substep / w->h * ob_max(0, -gain))))
		return 0;
	const double off = curvature(w, contact) + .5 * w->h * ob_max(0, -gain);
	return tolerance > 0 ? ob_min(off, share * tolerance) : off;
}

void ob_impacts_begin(ob_solver *s)
{
	ob_island_work *w = &s->island;
	w->last_impact = 0;
	w->plastic = s->methods.instants;
	const bool any = w->elastic || w->plastic;
	for (uint32_t i = 0; i < w->rows && any; i++)
		w->body[i].hit = 0;
	for (uint32_t i = 0; i < w->contacts && any; i++) {
		ob_contact *c = &w->contact[i];
		c->rebounds = 0;
		c->as_of_instant = c->left_to_solver = c->misses = false;
	}
}

bool ob_impacts_resolve(ob_solver *s, bool first)
{
	ob_island_work *w = &s->island;
	uint32_t round = 0;
	bool any = false;
	for (uint32_t i = 0; i < w->contacts && !any; i++)
		any = may_hit(w, &w->contact[i]);
	if (!any)
		return false;
	ob_set_drift(w);
	reserve(w);
	ob_machines_find(w);
	s->methods.read(s, w->v, 0);
	look_at_all(s, first);
	while (w->impacts.count && round < max_rounds && !ob_budget_spent(s)) {
		ob_budget_note(s, w->impacts.count);
		const uint32_t selected = join_touching(s, select_earliest(w));
		solve_selected(s, selected);
		round++;
		if (s->methods.read(s, w->v, round))
			look_at_all(s, true);
		else
			look_again(s, round, selected);
	}
	s->counters.impact_iterations += round;
	return round > 0;
}

void ob_impacts_finish(ob_impacts *x)
{
	free(x->pending);
	free(x->next);
	free(x->seen);
	free(x->set);
	free(x->point);
	free(x->machine);
	free(x->root);
	free(x->first);
	free(x->slot);
	free(x->head);
	free(x->row);
	free(x->changed);
	free(x->at);
	free(x->body);
	free(x->before);
}
