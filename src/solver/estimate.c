#include "solver/estimate.h"

#include "motion/deviation.h"
#include "solver/probe.h"

// PERIOD: steps from one estimate to the next. WATCHED_BODIES: islands of up to so many have one at each change, too.
enum { PERIOD = 16, WATCHED_BODIES = 2 };
static const uint64_t no_limit = UINT64_MAX;

bool ob_estimate_create(ob_solver *s)
{
	if (!(s->settings->tolerance > 0) || s->methods.sides > 1)
		return true;
	s->estimate.bound = ob_deviation_code(s->settings->tolerance);
	return (s->estimate.probe = ob_probe_create(s->settings, s->settings->substeps));
}

void ob_estimate_finish(ob_solver *s)
{
	ob_probe_destroy(s->estimate.probe);
}

// True if a contact has begun, ended, or was hit in the step.
static bool contacts_changed(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->contacts; i++) {
		const ob_contact *c = &w->contact[i];
		if ((c->lane == OB_NO_LANE) != c->began || c->rebounds)
			return true;
	}
	return false;
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
	if (!s->estimate.probe || w->balanced || is_free(w))
		return 0;
	if ((s->in->step + w->body[1].id) % PERIOD == 0)
		return PERIOD;
	return w->bodies <= WATCHED_BODIES && contacts_changed(w);
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

void ob_estimate_update(ob_solver *s)
{
	ob_island_work *w = &s->island;
	const double h = s->settings->step_length;
	const uint32_t weight = weight_of(s);
	double speed;
	if (weight) {
		ob_solver_enter(s, OB_PROFILE_ESTIMATE);
		(void)ob_probe_solve(s->estimate.probe, s->in, w->substeps > 1 ? w->substeps / 2 : 2, no_limit);
		s->counters.estimates += w->bodies;
	}
	for (uint32_t row = 1; row <= w->bodies; row++) {
		const ob_motion *last = s->in->object[row - 1].motion;
		const uint16_t before = ob_deviation_at(last->deviation, last->step, s->in->step + 1, h);
		uint16_t *now = &w->body[row].deviation;
		*now = before;
		if (weight) {
			const double error = ob_probe_distance(s->estimate.probe, w, row, &speed);
			*now = ob_deviation_code(ob_deviation(before) +
						 weight * h * ob_error_of_second(error, speed, h));
		}
		count(s, before, *now);
	}
}
