#include "solver/error_control.h"

#include <stdlib.h>

#include "shape/shape.h"
#include "solver/contacts.h"
#include "solver/joints.h"

static const uint32_t max_substeps = OB_MAX_SUBSTEPS;
static_assert(1 << (OB_SUBSTEP_CHOICES - 1) == OB_MAX_SUBSTEPS, "each number of substeps has its place");
static const uint32_t max_substeps_for_creep = 64; // more do not help friction to hold
static const double creep_time = 1; // s: time for which slip is remembered
static const double sticking_share = .999; // share of its bound: friction holds if its impulse is smaller
static const double aim = .9; // share of the tolerance: a step that ends at all of it leaves nothing to the next
static const double error_ratio = 8; // factor by which the error may grow with half as many substeps

uint32_t ob_error_control_substeps(const ob_solver *s, const ob_island_input *in)
{
	const ob_run_settings *run = s->settings;
	uint32_t most = run->substeps;
	if (!(run->tolerance > 0))
		return most;
	for (uint32_t i = 0; i < in->members; i++) {
		const bool of_lone_body = in->members > 1 && !ob_flies_with_joints(in) && ob_is_refined(&in->object[i]);
		uint32_t asked = of_lone_body ? 0 : in->object[i].motion->substeps;
		most = asked > most && asked <= max_substeps ? asked : most;
	}
	return most;
}

static bool has_tolerance(const ob_solver *s)
{
	return s->settings->tolerance > 0;
}

// ---- notes

void ob_error_control_note_depth(ob_solver *s, bool at_start)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; has_tolerance(s) && i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		if (contact->lane == OB_NO_LANE)
			continue;
		double depth = ob_max(0, -ob_contact_gap(w, contact));
		if (at_start)
			contact->initial_depth = depth;
		else if (depth > contact->initial_depth) {
			w->new_error = ob_max(w->new_error, depth);
			contact->depth_growth = ob_max(contact->depth_growth, depth - contact->initial_depth);
		}
		w->depth = ob_max(w->depth, depth);
	}
}

// Returns the slip (m/s) at the contact's centroid in the solution, if friction holds it; else 0.
static double slip_of(const ob_island_work *w, const ob_contact *contact)
{
	const ob_batch *b = &w->batch[contact->lane / OB_LANES];
	const uint32_t l = contact->lane % OB_LANES;
	const double *va = w->u[contact->a], *vb = w->u[contact->b];
	double sum = 0, rate[2] = { 0, 0 };
	for (uint32_t j = 0; j < contact->points; j++)
		sum += b->impulse[j][l];
	double bound = sticking_share * contact->mu * sum;
	if (b->slides >> l & 1 ||
	    !(b->impulse[4][l] * b->impulse[4][l] + b->impulse[5][l] * b->impulse[5][l] < bound * bound))
		return 0;
	for (int c = 0; c < 3; c++) {
		rate[0] += b->t1[c][l] * (va[c] - vb[c]) + b->fa1[c][l] * va[3 + c] - b->fb1[c][l] * vb[3 + c];
		rate[1] += b->t2[c][l] * (va[c] - vb[c]) + b->fa2[c][l] * va[3 + c] - b->fb2[c][l] * vb[3 + c];
	}
	for (int k = 0; k < 2 && b->turning >> l & 1; k++)
		rate[k] += b->turn[4 + k][l];
	return sqrt(rate[0] * rate[0] + rate[1] * rate[1]);
}

void ob_error_control_note_slip(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t i = 0; has_tolerance(s) && i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		if (contact->lane != OB_NO_LANE && contact->mu > 0)
			contact->slip += w->h * slip_of(w, contact);
	}
}

void ob_error_control_note_bounce(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double tolerance = s->settings->tolerance;
	const ob_impact_rows at = { w->v, w->drift, w->d };
	double lost = 0;
	for (uint32_t i = 0; has_tolerance(s) && w->elastic && w->max_acceleration > 0 && i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		if (contact->lane == OB_NO_LANE || !(contact->e > 0))
			continue;
		// m/s: approach that would rebound to the height of the tolerance; slowest approach that is resolved
		double tolerable = sqrt(2 * w->max_acceleration * tolerance) / contact->e,
		       resolved = 4 * w->max_acceleration * w->substep;
		ob_impact slow = { .h = w->h, .threshold = tolerable, .gain = INFINITY, .points = ~0u };
		if (resolved > tolerable &&
		    ob_impact_time(&w->batch[contact->lane / OB_LANES], contact->lane % OB_LANES, &slow, &at) <= slow.h)
			lost = ob_max(lost, contact->e * contact->e * resolved * resolved / (2 * w->max_acceleration));
	}
	w->bounce = ob_max(w->bounce, lost);
	w->new_error = ob_max(w->new_error, lost);
}

// ---- accepting a solution, or asking for another

// Returns the share of the accumulated slip that is forgotten in a step.
static double fading_of(const ob_island_work *w, const ob_run_settings *run)
{
	return ob_min(1, run->step_length / (creep_time * ob_coarse_time(w)));
}

static int by_height(const void *a, const void *b)
{
	const ob_height *x = a, *y = b;
	return x->height != y->height ? (x->height < y->height ? -1 : 1) : (x->row > y->row) - (x->row < y->row);
}

// True if the contact holds the body up.
static bool carries(const ob_island_work *w, const ob_contact *c, uint32_t row)
{
	static const double upright = .25; // least cosine of normal and vertical
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	const uint32_t l = c->lane % OB_LANES;
	const ob_vec3 a = w->body[row].acceleration;
	const double up = -(b->n[0][l] * a.x + b->n[1][l] * a.y + b->n[2][l] * a.z);
	return (row == c->a ? up : -up) > upright * ob_norm(a);
}

// Sums what the step adds to depths along what carries what, from the lowest body to the highest.
static void note_sinking(ob_solver *s)
{
	static const double not_summed = -1;
	ob_island_work *w = &s->island;
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_vec3 a = w->body[row].acceleration, p = w->body[row].p;
		w->by_height[row - 1] = (ob_height){ ob_norm2(a) > 0 ? -ob_dot(a, p) / ob_norm(a) : 0, row };
		w->body[row].sinking = not_summed;
	}
	qsort(w->by_height, w->bodies, sizeof *w->by_height, by_height);
	for (uint32_t i = 0; i < w->bodies; i++) {
		const uint32_t row = w->by_height[i].row;
		ob_body *body = &w->body[row];
		body->sinking = 0;
		for (uint32_t k = 0; k < body->adjacent; k++) {
			const ob_contact *c = &w->contact[w->adjacency[body->first_adjacent + k]];
			const ob_body *below = &w->body[c->a == row ? c->b : c->a];
			const double sunk = below->inv_mass > 0 ? below->sinking : 0;
			if (c->lane != OB_NO_LANE && sunk >= 0 && carries(w, c, row))
				body->sinking = ob_max(body->sinking, c->depth_growth + sunk);
		}
	}
}

// Accumulates slip. It fades over the creep time.
static void note_creep(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	const double tolerance = run->tolerance, fading = fading_of(w, run);
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		contact->creep = contact->creep * (1 - fading) + contact->slip;
		w->creep = ob_max(w->creep, contact->creep);
		bool goes_on = contact->slip > fading * tolerance && w->substeps < max_substeps_for_creep;
		if (contact->creep > tolerance && (goes_on || contact->slip > .5 * tolerance))
			w->new_error = ob_max(w->new_error, contact->creep);
	}
}

// Returns the number of substeps that a contact needs. It grows before the error is too large, so that few islands are
// solved twice; it falls if the error would stay tolerable.
static uint32_t substeps_for(const ob_island_work *w, const ob_contact *contact, const ob_run_settings *run)
{
	const double tolerance = run->tolerance, fading = fading_of(w, run);
	double depth = contact->initial_depth + contact->depth_growth,
	       creep = contact->slip / fading; // sum to which slip at this rate converges
	double change = ob_max(depth, contact->creep) > .5 * tolerance ? ob_max(contact->depth_growth, creep)
								       : contact->depth_growth;
	uint32_t n = w->substeps;
	if (contact->creep > .75 * tolerance && creep > tolerance && n < max_substeps_for_creep)
		n *= 2;
	for (; n >= 2 * run->substeps && change * error_ratio <= tolerance; change *= error_ratio)
		n /= 2;
	return n;
}

// Sets each body's next substeps to the largest number that its contacts need.
static void set_next_substeps(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	for (uint32_t i = 0; i < w->rows; i++)
		w->body[i].next_substeps = w->joints.count ? ob_joints_substeps(s) : run->substeps;
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *contact = &w->contact[i];
		uint32_t n = substeps_for(w, contact, run);
		for (int side = 0; side < 2; side++) {
			ob_body *body = &w->body[side ? contact->b : contact->a];
			body->next_substeps = n > body->next_substeps ? n : body->next_substeps;
		}
	}
}

// True if corners of either body may be no contact points: those of a round one are all that there are.
static bool may_have_more_corners(const ob_island_work *w, const ob_contact *contact)
{
	const ob_shape a = w->body[contact->a].shape, b = w->body[contact->b].shape;
	return ob_shape_is(a, OB_CORNERED | OB_UNBOUNDED) && ob_shape_is(b, OB_CORNERED | OB_UNBOUNDED);
}

// Finds contacts anew that may be deeper than the tolerance: corners that were no contact points approach by the path at most.
static void renew_deep(ob_solver *s)
{
	const ob_island_work *w = &s->island;
	for (uint32_t i = 0; i < w->contacts; i++) {
		ob_contact *contact = &w->contact[i];
		if (contact->lane == OB_NO_LANE || contact->since == 0 || !may_have_more_corners(w, contact) ||
		    !(contact->path - ob_contact_gap(w, contact) > s->settings->tolerance))
			continue;
		s->counters.narrowphase_tests++;
		ob_contact_find(s, contact);
	}
}

bool ob_error_control_accept(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double tolerance = s->settings->tolerance;
	if (!has_tolerance(s))
		return true;
	ob_contacts_update(s, 0);
	renew_deep(s);
	ob_error_control_note_depth(s, false);
	note_creep(s);
	w->error = ob_max(w->depth, ob_max(w->creep, w->bounce));
	if (w->new_error > aim * tolerance && w->substeps < max_substeps) {
		w->substeps *= w->new_error > 16 * tolerance ? 4 : 2;
		w->substeps = w->substeps < max_substeps ? w->substeps : max_substeps;
		return false;
	}
	const bool floats = w->max_acceleration == 0 && ob_norm2(w->frame) > 0;
	if (w->new_error > tolerance && floats && !w->in_field) {
		w->in_field = true;
		w->substeps = s->settings->substeps;
		return false;
	}
	set_next_substeps(s);
	if (s->estimate.probe) // a probe has no use for it
		note_sinking(s);
	return true;
}

void ob_error_control_count(ob_solver *s)
{
	const ob_island_work *w = &s->island;
	if (!has_tolerance(s))
		return;
	s->counters.islands_over += w->error > s->settings->tolerance;
	s->counters.error = ob_max(s->counters.error, w->error);
	s->counters.depth = ob_max(s->counters.depth, w->depth);
	s->counters.creep = ob_max(s->counters.creep, w->creep);
	s->counters.bounce = ob_max(s->counters.bounce, w->bounce);
	s->counters.chosen[31 - __builtin_clz(w->substeps)]++;
}
