#include "solver/estimate.h"

#include "motion/deviation.h"
#include "solver/probe.h"
#include "solver/refinement.h"

// PERIOD: steps from one estimate to the next; SOON: of a lone body, after one above the tolerance. WATCHED_BODIES:
// islands of up to so many have one at each change, too.
enum { PERIOD = 16, SOON = 4, WATCHED_BODIES = 2 };

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

// Returns the number of steps for which an estimate of this step stands; 0: none is due.
static uint32_t weight_of(const ob_solver *s)
{
	const ob_island_work *w = &s->island;
	// Estimates of lone bodies choose substeps, so they do not depend on ids: a scene in another order ends alike.
	const uint64_t phase = s->in->step + (w->bodies > 1 ? w->body[1].id : 0);
	if (!s->estimate.probe || w->balanced || is_free(w))
		return 0;
	if (phase % PERIOD == 0)
		return PERIOD;
	if (phase % SOON == 0 && ob_refinement_is_doubted(s))
		return 1;
	return w->bodies <= WATCHED_BODIES && ob_contacts_changed(w);
}

// Counts the steps of a second of which more is not bounded now: the last one, or all when the bound is exceeded.
static void count(ob_solver *s, uint16_t before, uint16_t now)
{
	const uint16_t bound = s->estimate.bound;
	if (now > bound)
		s->counters.unbounded +=
			before > bound ? 1 : ob_steps_of_second(s->in->step + 1, s->settings->step_length);
	if (now > s->estimate.largest) {
		s->estimate.largest = now;
		s->counters.deviation = ob_max(s->counters.deviation, ob_deviation(now));
	}
}

// Updates the deviation of a body; an estimate counts for `weight` steps. Returns the body's error of a second.
static double update_deviation(ob_solver *s, uint32_t row, uint32_t weight, double factor)
{
	ob_island_work *w = &s->island;
	const ob_motion *last = s->in->object[row - 1].motion;
	const double h = s->settings->step_length;
	const uint16_t before = ob_deviation_at(last->deviation, last->step, s->in->step + 1, h);
	double speed = 0, error = weight ? factor * ob_probe_distance(s->estimate.probe, w, row, &speed) : 0;
	speed *= factor;
	w->body[row].deviation = before;
	if (weight)
		w->body[row].deviation =
			ob_deviation_code(ob_deviation(before) + weight * h * ob_error_of_time(error, speed, h, 1));
	count(s, before, w->body[row].deviation);
	return ob_error_of_run(s, error, speed);
}

void ob_estimate_update(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const bool refined = w->bodies == 1 && ob_is_refined(&s->in->object[0]);
	const uint32_t weight = weight_of(s), n = w->substeps;
	double error = 0;
	if (weight) {
		ob_solver_enter(s, OB_PROFILE_ESTIMATE);
		ob_probe_solve(s->estimate.probe, s->in, refined || n < 2 || w->joints.count ? 2 * n : n / 2);
		s->counters.estimates += w->bodies;
	}
	for (uint32_t row = 1; row <= w->bodies; row++)
		error = ob_max(error, update_deviation(s, row, weight, refined ? 2 : 1));
	if (s->estimate.probe && !w->balanced)
		ob_refinement_update(s, weight, error);
}
