#include "solver/estimate.h"

#include "motion/deviation.h"
#include "shape/shape.h"
#include "solver/budget.h"
#include "solver/island_solver.h"
#include "solver/joints.h"
#include "solver/probe.h"
#include "solver/refinement.h"
#include "solver/surfaces.h"

// PERIOD: steps from one estimate to the next; SOON: of a lone body, after one above the tolerance. FEW_BODIES: islands of up
// to so many have one where a body lands, too; of up to OB_WATCHED_BODIES at each change. BY_FAR: tolerances from which on a
// second that exceeds is not doubted.
enum { PERIOD = 16, SOON = 4, FEW_BODIES = 8, BY_FAR = 8 };

bool ob_estimate_create(ob_solver *s)
{
	if (!(s->settings->tolerance > 0) || s->methods.sides > 1)
		return true;
	s->estimate.probe = ob_probe_create(s->settings, s->settings->substeps);
	s->estimate.finer = ob_probe_create(s->settings, s->settings->substeps);
	return s->estimate.probe && s->estimate.finer;
}

void ob_estimate_finish(ob_solver *s)
{
	ob_probe_destroy(s->estimate.probe);
	ob_probe_destroy(s->estimate.finer);
}

static bool is_free(const ob_island_work *w)
{
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (!w->body[row].moved_freely)
			return false;
	return true;
}

// True if bodies rebounded from each other. The hits of a lone body are found at their instants, and need no estimate.
static bool hit_each_other(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->contacts && w->bodies > 1; i++)
		if (w->contact[i].hit)
			return true;
	return false;
}

// Returns the deviation (m) at the end of the running second.
static double of_second(const ob_solver *s, ob_deviation d)
{
	return ob_deviation_of_second(d, s->in->step + 1, s->settings->step_length);
}

// True if a body lands that was in flight: on few others, or where none is off so far.
static bool lands(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	bool landed = false, clean = true;
	for (uint32_t row = 1; row <= w->bodies; row++) {
		landed |= !w->body[row].moved_freely && s->in->object[row - 1].motion->flags & OB_MOTION_FREE;
		clean &= of_second(s, w->body[row].deviation) <= s->settings->tolerance;
	}
	return landed && (w->bodies <= FEW_BODIES || clean);
}

// True if the forces on one of few bodies change within the step, as where a block comes over an edge: a substep of the change
// may take a second beyond the tolerance.
static bool is_jolted(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	return !ob_flies_with_joints(s->in) && w->jolt * ob_coarse_time(w) > .5 * w->substeps * s->settings->tolerance;
}

// True for a lone body that rolls, or is driven by a surface that swings, turns or runs: a step in which something happens is
// solved finer. (Boxes that rattle have five times as many.)
static bool follows_events(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	if (w->bodies != 1 || w->joints.count || !s->estimate.probe)
		return false;
	return ob_shape_is(w->body[1].shape, OB_ROUND) || ob_surfaces_drive(w);
}

// True if an estimate has no use: the second of each body exceeds the tolerance already, and refinement does not ask.
static bool is_useless(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	if (follows_events(s))
		return false;
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (of_second(s, w->body[row].deviation) <= s->settings->tolerance)
			return false;
	return w->bodies > 1 || ob_contacts_changed(w) || is_jolted(s);
}

// Returns the number of steps for which an estimate of this step stands; 0: none is due.
static uint32_t weight_of(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	// Estimates of lone bodies choose substeps, so they do not depend on ids: a scene in another order ends alike.
	const uint64_t phase = s->in->step + (w->bodies > 1 ? w->body[1].id : 0);
	if (!s->estimate.probe || w->balanced || is_free(w) || is_useless(s))
		return 0;
	const bool changed = ob_contacts_changed(w) || hit_each_other(w);
	if (w->bodies <= OB_WATCHED_BODIES && (changed || is_jolted(s)))
		return 1; // it stands for no other step
	if (phase % PERIOD == 0)
		return PERIOD;
	return (phase % SOON == 0 && ob_refinement_is_doubted(s)) || (changed && lands(s));
}

ob_deviation ob_estimate_count(ob_solver *s, uint64_t step, ob_deviant before, ob_deviant now, bool flies)
{
	const double h = s->settings->step_length, tolerance = s->settings->tolerance;
	const double second = ob_deviation_of_second(now.deviation, step, h);
	if (flies && second > tolerance)
		now.deviation = (ob_deviation){ second, 0 };
	if (before.deviation.place <= tolerance && now.deviation.place > tolerance)
		s->counters.unbounded += (uint64_t)llround(1 / h);
	s->counters.deviation =
		ob_max(s->counters.deviation, ob_min(now.deviation.place, ob_max(before.speed, now.speed)));
	return now.deviation;
}

// Returns the row's deviation at the end of the running step, if it adds none.
static ob_deviation deviation_before(const ob_solver *s, uint32_t row)
{
	if (!row || row > s->island.bodies)
		return (ob_deviation){ 0, 0 };
	return ob_deviation_at(s->in->object[row - 1].motion, s->in->step + 1, s->settings->step_length);
}

// Lets a body, if it moves, leave the hit of a contact in which it or the other one was off by "most" at most. Where that
// is more than the way to the next point, that one may hit first, and the body leaves in any direction.
static void leave_hit(ob_solver *s, const ob_contact *c, uint32_t row, ob_deviation most)
{
	ob_island_work *w = &s->island;
	if (!row || row > w->bodies)
		return;
	ob_body *body = &w->body[row];
	const ob_motion *last = s->in->object[row - 1].motion;
	const double *v = w->v[row], change = ob_norm(ob_sub(ob_row_linear(v), last->v)) +
					      body->radius * ob_norm(ob_sub(ob_row_angular(v), last->w));
	const double radius = 2 * most.place < c->next_point ? body->radius : 0;
	body->deviation = ob_deviation_larger(body->deviation, ob_deviation_after_hit(most, change, radius));
}

// True if a face of the contact lies on the other body and sticks to it.
static bool lies_on_face(const ob_island_work *w, const ob_contact *c)
{
	if (c->lane == OB_NO_LANE)
		return false;
	const ob_batch *b = &w->batch[c->lane / OB_LANES];
	int loaded = 0;
	for (uint32_t j = 0; j < c->points; j++)
		loaded += b->impulse[j][c->lane % OB_LANES] > 0;
	return loaded >= 3 && !(b->slides >> c->lane % OB_LANES & 1);
}

// Takes errors of velocity from what lies on others, from the lowest to the highest: it moves as they do.
static void carry_along(ob_island_work *w)
{
	for (uint32_t i = 0; i < w->bodies; i++) {
		ob_body *body = &w->body[w->by_height[i].row];
		for (uint32_t k = 0; k < body->adjacent; k++) {
			const ob_contact *c = &w->contact[w->adjacency[body->first_adjacent + k]];
			const ob_body *other = &w->body[&w->body[c->a] == body ? c->b : c->a];
			if (lies_on_face(w, c))
				body->deviation.rate = ob_min(body->deviation.rate, other->deviation.rate);
		}
	}
}

// Sets the deviations of bodies to those before the step, and of those that hit each other to what follows.
static void hand_over(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t row = 1; row <= w->bodies; row++)
		w->body[row].deviation = deviation_before(s, row);
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *c = &w->contact[i];
		if (!c->hit && (!c->began || c->lane == OB_NO_LANE))
			continue;
		const ob_deviation most = ob_deviation_larger(deviation_before(s, c->a), deviation_before(s, c->b));
		if (!(most.place > 0))
			continue;
		leave_hit(s, c, c->a, most);
		leave_hit(s, c, c->b, most);
	}
	if (s->estimate.probe) // bodies are in their order
		carry_along(w);
}

// Returns the number of substeps of a coarser solution. No instant within the step is the end of a substep in both, or a
// contact that ends within a substep of either may end at the same instant in both. Among several bodies it matters less.
static uint32_t coarser_than(uint32_t n, uint32_t bodies)
{
	return bodies <= OB_WATCHED_BODIES && n > 2 ? n / 2 + 1 : n / 2;
}

// Solution beside which the step's own stands: its distance times the factor bounds the step's error.
typedef struct ruler {
	const ob_probe *probe;
	double factor;
} ruler;

// Solutions beside which a step's own stands.
typedef struct rulers {
	ruler by[2];
	int count;
	bool coarser; // the first has fewer substeps
} rulers;

// Returns the error of a step by the ruler that makes the shorter second.
static ob_deviation error_by(const ob_solver *s, const rulers *r, uint32_t row)
{
	ob_deviation least = { 0, 0 };
	for (int i = 0; i < r->count; i++) {
		double rate = 0, place = ob_probe_distance(r->by[i].probe, &s->island, row, &rate);
		const ob_deviation e = { r->by[i].factor * place, r->by[i].factor * rate };
		if (i == 0 || of_second(s, e) < of_second(s, least))
			least = e;
	}
	return least;
}

// Returns the deviation with such errors in so many steps.
static ob_deviation with(ob_deviation d, ob_deviation error, uint32_t weight)
{
	return (ob_deviation){ d.place + weight * error.place, d.rate + weight * error.rate };
}

// Solves the island beside its solution, with fewer substeps, or with twice as many where they were refined.
static rulers solve_beside(ob_solver *s)
{
	const ob_island_work *w = &s->island;
	const uint32_t n = w->substeps;
	const bool flies = ob_flies_with_joints(s->in),
		   refined = w->bodies == 1 && !flies && ob_is_refined(&s->in->object[0]),
		   finer = flies ? ob_joints_finer(s, n)
				 : (refined || n < 2 || w->joints.count) && 2 * n <= OB_MAX_SUBSTEPS;
	const uint32_t other = finer ? 2 * n : coarser_than(n, w->bodies);
	ob_probe_solve(s->estimate.probe, s, other, n);
	return (rulers){ { { s->estimate.probe, refined ? 2
						: finer ? 1
							: (double)other / (n - other) } },
			 1,
			 !finer && !flies };
}

// Solves the step of a lone body again, in place of its solution, with four times as many substeps, while its error half a
// second later is large, and falls at least as their number grows.
static void solve_event(ob_solver *s, rulers *r)
{
	enum { TIMES = 4, MOST = 16 }; // by the last number; by the run's substeps
	static const double large = .25; // share of the tolerance
	const ob_island_work *w = &s->island;
	double last = INFINITY;
	for (;;) {
		const ob_deviation e = error_by(s, r, 1);
		const double error = e.place + .5 * ob_coarse_time(w) * e.rate;
		if (!(error > large * s->settings->tolerance && TIMES * error <= last) ||
		    TIMES * w->partial > MOST * s->settings->substeps)
			return;
		last = error;
		ob_island_step_finer(s, TIMES * w->substeps);
		ob_solver_enter(s, OB_PROFILE_ESTIMATE);
		hand_over(s);
		*r = solve_beside(s);
	}
}

// Adds the errors of so many steps to a body's deviation.
static void update_deviation(ob_solver *s, const rulers *r, uint32_t row, uint32_t weight)
{
	ob_body *body = &s->island.body[row];
	body->deviation = with(body->deviation, error_by(s, r, row), weight);
	body->deviation.place += body->sinking;
	const ob_motion *last = s->in->object[row - 1].motion;
	const double *v = s->island.v[row];
	const uint64_t step = s->in->step + 1;
	const ob_deviant before = { ob_deviation_published(last, step, s->settings->step_length),
				    ob_surface_speed(last->v, last->w, body->radius) },
			 now = { body->deviation, ob_surface_speed(ob_row_linear(v), ob_row_angular(v), body->radius) };
	body->deviation = ob_estimate_count(s, step, before, now, false);
}

// Returns a row's error (m) of a second; among contacts in the units of the run.
static double error_of_second(const ob_solver *s, const rulers *r, uint32_t row)
{
	const ob_deviation error = error_by(s, r, row);
	if (ob_flies_with_joints(s->in))
		return ob_error_of_time(error.place, error.rate, s->settings->step_length, 1);
	return ob_error_of_run(s, error.place, error.rate);
}

// True if an estimate takes one of few bodies beyond the tolerance, but none by far: then a finer solution may deny it.
static bool is_doubtful(const ob_solver *s, const rulers *r, uint32_t weight)
{
	const double tolerance = s->settings->tolerance;
	double most = 0;
	for (uint32_t row = 1; s->island.bodies <= OB_WATCHED_BODIES && row <= s->island.bodies; row++) {
		const ob_deviation before = s->island.body[row].deviation;
		const ob_deviation after = with(before, error_by(s, r, row), weight);
		if (of_second(s, before) <= tolerance)
			most = ob_max(most, of_second(s, after));
	}
	return most > tolerance && most <= BY_FAR * tolerance;
}

void ob_estimate_update(ob_solver *s)
{
	ob_island_work *w = &s->island;
	if (ob_budget_spent(s)) // there is no solution, so bodies are in no order, and nothing of them is used
		return;
	hand_over(s);
	const uint32_t weight = weight_of(s);
	const bool jolted = is_jolted(s);
	rulers r = { .count = 0 };
	double error = 0;
	if (weight) {
		ob_solver_enter(s, OB_PROFILE_ESTIMATE);
		r = solve_beside(s);
		s->counters.estimates += w->bodies;
		if (follows_events(s) && (jolted || ob_contacts_changed(w)))
			solve_event(s, &r);
		const uint32_t n = w->substeps;
		for (uint32_t row = 1; row <= w->bodies; row++)
			error = ob_max(error, error_of_second(s, &r, row));
		if (r.coarser && 2 * n < OB_MAX_SUBSTEPS && is_doubtful(s, &r, weight)) {
			ob_probe_solve(s->estimate.finer, s, 2 * n + 1, n);
			r.by[r.count++] = (ruler){ s->estimate.finer, (2 * n + 1.) / (n + 1) };
		}
	}
	for (uint32_t row = 1; row <= w->bodies; row++)
		update_deviation(s, &r, row, weight);
	if (s->estimate.probe && !w->balanced)
		ob_refinement_update(s, weight && !jolted, error);
}
