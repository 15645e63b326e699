#include "solver/estimate.h"

#include "motion/deviation.h"
#include "solver/probe.h"
#include "solver/refinement.h"

// PERIOD: steps from one estimate to the next; SOON: of a lone body, after one above the tolerance. FEW_BODIES: islands of up
// to so many have one where a body lands, too; of up to OB_WATCHED_BODIES at each change.
enum { PERIOD = 16, SOON = 4, FEW_BODIES = 8 };

bool ob_estimate_create(ob_solver *s)
{
	if (!(s->settings->tolerance > 0) || s->methods.sides > 1)
		return true;
	s->estimate.bound = ob_deviation_code(s->settings->tolerance);
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

// True if few bodies touch of which one was in flight before.
static bool lands(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	for (uint32_t row = 1; w->bodies <= FEW_BODIES && row <= w->bodies; row++)
		if (!w->body[row].moved_freely && s->in->object[row - 1].motion->flags & OB_MOTION_FREE)
			return true;
	return false;
}

// True if the forces on one of few bodies change within the step, as where a block comes over an edge: a substep of the change
// may take a second beyond the tolerance.
static bool is_jolted(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	return w->jolt * ob_coarse_time(w) > .5 * w->substeps * s->settings->tolerance;
}

// True if an estimate has no use: the second of each body exceeds the tolerance already, and refinement does not ask.
static bool is_useless(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	for (uint32_t row = 1; row <= w->bodies; row++)
		if (w->body[row].deviation <= s->estimate.bound)
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

void ob_estimate_count(ob_solver *s, uint16_t before, uint16_t now)
{
	const uint16_t bound = s->estimate.bound;
	if (before <= bound && now > bound)
		s->counters.unbounded += (uint64_t)llround(1 / s->settings->step_length);
	if (now > s->estimate.largest) {
		s->estimate.largest = now;
		s->counters.deviation = ob_max(s->counters.deviation, ob_deviation(now));
	}
}

// Returns the code of a row's deviation at the end of the running step, if it adds none.
static uint16_t deviation_before(const ob_solver *s, uint32_t row)
{
	const ob_motion *last = row && row <= s->island.bodies ? s->in->object[row - 1].motion : NULL;
	return last ? ob_deviation_at(last->deviation, last->step, s->in->step + 1, s->settings->step_length) : 0;
}

// Lets a body, if it moves, leave a hit in which it or the other one was off by "most" at most.
static void leave_hit(ob_solver *s, uint32_t row, uint16_t most)
{
	ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	if (!row || row > w->bodies)
		return;
	ob_body *body = &w->body[row];
	const ob_motion *last = s->in->object[row - 1].motion;
	const double *v = w->v[row], change = ob_norm(ob_sub(ob_row_linear(v), last->v)) +
					      body->radius * ob_norm(ob_sub(ob_row_angular(v), last->w));
	const uint16_t after =
		ob_deviation_after_hit(most, change, body->radius, ob_left_of_second(s->in->step + 1, h));
	if (after <= body->deviation)
		return;
	ob_estimate_count(s, body->deviation, after);
	body->deviation = after;
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
		const uint16_t a = deviation_before(s, c->a), b = deviation_before(s, c->b), most = a > b ? a : b;
		if (!most)
			continue;
		leave_hit(s, c->a, most);
		leave_hit(s, c->b, most);
	}
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

// Returns the error of a second (m) by the shorter of n rulers, in the units of the run; added: m, by the steps for which the
// estimate stands.
static double error_by(const ob_solver *s, const ruler *r, int n, uint32_t row, uint32_t weight, double *added)
{
	const double h = s->settings->step_length;
	double least = 0;
	*added = 0;
	for (int i = 0; i < n; i++) {
		double speed = 0, error = r[i].factor * ob_probe_distance(r[i].probe, &s->island, row, &speed);
		speed *= r[i].factor;
		const double sum = weight * h * ob_error_of_time(error, speed, h, 1);
		if (i && !(sum < *added))
			continue;
		*added = sum;
		least = ob_error_of_run(s, error, speed);
	}
	return least;
}

// Updates the deviation of a body. Returns its error of a second.
static double update_deviation(ob_solver *s, const ruler *r, int n, uint32_t row, uint32_t weight)
{
	ob_body *body = &s->island.body[row];
	const uint16_t before = body->deviation; // and what a hit made of it
	double added = 0;
	const double error = weight ? error_by(s, r, n, row, weight, &added) : 0;
	if (weight)
		body->deviation = ob_deviation_code(ob_deviation(before) + added);
	ob_estimate_count(s, before, body->deviation);
	return error;
}

// True if an estimate takes a body beyond the tolerance.
static bool exceeds(const ob_solver *s, const ruler *r, uint32_t weight)
{
	for (uint32_t row = 1; row <= s->island.bodies; row++) {
		const uint16_t before = s->island.body[row].deviation;
		double added;
		error_by(s, r, 1, row, weight, &added);
		if (before <= s->estimate.bound && ob_deviation_code(ob_deviation(before) + added) > s->estimate.bound)
			return true;
	}
	return false;
}

void ob_estimate_update(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const bool refined = w->bodies == 1 && ob_is_refined(&s->in->object[0]);
	hand_over(s);
	const uint32_t weight = weight_of(s), n = w->substeps;
	const bool may_double = 2 * n <= OB_MAX_SUBSTEPS, finer = (refined || n < 2 || w->joints.count) && may_double;
	const uint32_t other = finer ? 2 * n : coarser_than(n, w->bodies);
	ruler r[2] = { { s->estimate.probe, refined ? 2 : finer ? 1 : (double)other / (n - other) } };
	int rulers = 1;
	double error = 0;
	if (weight) {
		ob_solver_enter(s, OB_PROFILE_ESTIMATE);
		ob_probe_solve(s->estimate.probe, s->in, other, n);
		s->counters.estimates += w->bodies;
		if (!finer && may_double && w->bodies <= FEW_BODIES && exceeds(s, r, weight)) {
			ob_probe_solve(s->estimate.finer, s->in, 2 * n + 1, n);
			r[rulers++] = (ruler){ s->estimate.finer, (2 * n + 1.) / (n + 1) };
		}
	}
	for (uint32_t row = 1; row <= w->bodies; row++)
		error = ob_max(error, update_deviation(s, r, rulers, row, weight));
	if (s->estimate.probe && !w->balanced)
		ob_refinement_update(s, weight && !is_jolted(s), error);
}
