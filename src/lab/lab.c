#include "lab/lab.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "lab/attempt.h"

// What is known of the time that a case takes; "work" is in steps of an engine, whatever that is in seconds.
typedef struct pace {
	double seconds, work, ahead;
} pace;

typedef struct session {
	const ob_lab_plan *plan;
	ob_results *results;
	ob_lab_progress progress;
	double begun; // of the attempt under way, s
	pace pace[OB_LIST_CASES]; // by place in the plan
	size_t at; // the case's place
	ob_run_settings settings[OB_SWEEP_SETTINGS];
} session;

static double work_of(const ob_case *c, const ob_run_settings *s)
{
	return c->duration / s->step_length * c->runs * (s->substeps ? s->substeps : 16);
}

// How often this is still to be done. Who ran out of time, or crashed, is not asked again, unless there is more time;
// nor who failed: errors are the same every time, and repeats are for the times of what succeeds.
static uint32_t repeats_left(const session *s, const ob_case *c, const ob_engine_kind *k, const ob_run_settings *at)
{
	const ob_result *r = ob_results_find(s->results, c, k, at);
	if (!r)
		return s->plan->repeats;
	if (isnan(r->outcome.body_seconds))
		return ob_attempt_had_less(&r->outcome, s->plan->limit) ? 1 : 0;
	if (r->outcome.failed[0])
		return 0;
	return r->repeats < s->plan->repeats ? s->plan->repeats - r->repeats : 0;
}

// Calls "with" for each engine and setting of a case, until one says no.
static bool each(session *s, bool (*with)(session *, const ob_engine_kind *, const ob_run_settings *, ob_error *),
		 ob_error *e)
{
	const ob_case *c = s->plan->cases.of[s->at];
	for (size_t i = 0; i < s->plan->engines.count; i++) {
		const ob_engine_kind *k = s->plan->engines.of[i];
		size_t count = ob_sweep_settings(&s->plan->sweep, c, k, s->settings);
		for (size_t j = 0; j < count; j++)
			if (!with(s, k, &s->settings[j], e))
				return false;
	}
	return true;
}

static bool count(session *s, const ob_engine_kind *k, const ob_run_settings *at, ob_error *e)
{
	const ob_case *c = s->plan->cases.of[s->at];
	uint32_t left = repeats_left(s, c, k, at);
	s->progress.all += left;
	s->pace[s->at].ahead += left * work_of(c, at);
	return true;
}

// A case of which nothing is known takes its time as all others do.
static double guess_left(const session *s)
{
	pace all = { 0 };
	double left = 0;
	for (size_t i = 0; i < s->plan->cases.count; i++) {
		all.seconds += s->pace[i].seconds;
		all.work += s->pace[i].work;
	}
	for (size_t i = 0; i < s->plan->cases.count; i++) {
		const pace *p = s->pace[i].work > 0 ? &s->pace[i] : &all;
		left += s->pace[i].ahead > 0 ? s->pace[i].ahead * p->seconds / p->work : 0;
	}
	return fmax(left - (ob_clock_wall() - s->begun), 0);
}

static void tick(void *with)
{
	session *s = with;
	s->progress.left = s->progress.done ? guess_left(s) : NAN;
	s->plan->tick(&s->progress, s->plan->with);
}

static bool keep(session *s, const ob_engine_kind *k, const ob_run_settings *at, const ob_outcome *out, ob_error *e)
{
	const ob_case *c = s->plan->cases.of[s->at];
	ob_result *r = ob_results_find(s->results, c, k, at);
	if (!r) {
		ob_result one = { .of = c, .engine = k, .settings = *at };
		memcpy(one.commit, s->results->commit, sizeof one.commit);
		if (!ob_results_add(s->results, &one))
			return ob_fail(e, "no memory for results");
		r = ob_results_find(s->results, c, k, at);
	}
	if (isnan(r->outcome.body_seconds)) // this time it had more time
		r->repeats = 0;
	ob_result_repeat(r, out);
	return ob_results_write(s->results, s->plan->file, e);
}

// Is a finer than b, with all else no coarser?
static bool is_finer(const ob_run_settings *a, const ob_run_settings *b)
{
	bool by_tolerance = a->tolerance > 0;
	return by_tolerance == (b->tolerance > 0) && a->iterations >= b->iterations &&
	       (by_tolerance ? a->tolerance < b->tolerance : a->substeps > b->substeps);
}

// The outcome of a setting that is finer than one that took too long: to be told without trying. NULL: there is none
static const ob_result *coarser_that_took_too_long(const session *s, const ob_engine_kind *k, const ob_run_settings *at)
{
	for (size_t i = 0; i < s->results->count; i++) {
		const ob_result *r = &s->results->result[i];
		if (r->of == s->plan->cases.of[s->at] && r->engine == k && is_finer(at, &r->settings) &&
		    ob_attempt_ran_out(&r->outcome) && !ob_attempt_had_less(&r->outcome, s->plan->limit))
			return r;
	}
	return NULL;
}

static bool try(session *s, const ob_engine_kind *k, const ob_run_settings *at, ob_outcome *out, ob_error *e)
{
	const ob_result *coarser = coarser_that_took_too_long(s, k, at);
	if (coarser) {
		*out = coarser->outcome;
		return true;
	}
	ob_attempt a = { s->plan->cases.of[s->at], k, *at, s->plan->limit, s->plan->tick ? tick : NULL, s };
	if (a.tick)
		tick(s);
	return ob_attempt_run(&a, out, e);
}

static bool attempt(session *s, const ob_engine_kind *k, const ob_run_settings *at, ob_error *e)
{
	const ob_case *c = s->plan->cases.of[s->at];
	uint32_t left = repeats_left(s, c, k, at);
	if (left == 0)
		return true;
	s->progress.of = c;
	s->progress.engine = k;
	s->progress.settings = *at;
	s->begun = ob_clock_wall();
	ob_outcome out;
	if (!try(s, k, at, &out, e) || !keep(s, k, at, &out, e))
		return false;
	uint32_t done = left - repeats_left(s, c, k, at); // all at once, if there is no use in more
	pace *p = &s->pace[s->at];
	p->seconds += ob_clock_wall() - s->begun;
	p->work += work_of(c, at);
	p->ahead -= done * work_of(c, at);
	s->progress.done += done;
	return true;
}

bool ob_lab_run(const ob_lab_plan *p, ob_results *r, ob_error *e)
{
	session *s = calloc(1, sizeof *s);
	if (!s)
		return ob_fail(e, "out of memory");
	*s = (session){ .plan = p, .results = r };
	for (s->at = 0; s->at < p->cases.count; s->at++)
		each(s, count, e);
	ob_attempts_begin();
	bool fine = true;
	for (s->at = 0; fine && s->at < p->cases.count; s->at++)
		for (uint32_t i = 0; fine && i < p->repeats; i++)
			fine = each(s, attempt, e);
	ob_attempts_end();
	if (!fine && ob_attempts_interrupted())
		ob_fail(e, "interrupted: %zu of %zu runs are done, and the same command goes on from there",
			s->progress.done, s->progress.all);
	free(s);
	return fine;
}
