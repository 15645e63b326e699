#include "paper/paper.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "base/clock.h"
#include "paper/trial.h"

enum { PAPER_EXPERIMENTS = 15, GROWING = 2, SUMS = 20000 };

static const uint32_t full_sizes[] = { 8, 16, 32, 64, 128, 256 }, quick_sizes[] = { 4, 8, 16 };
static const ob_paper_scenario growing[GROWING] = { OB_PAPER_COMMON, OB_PAPER_OBS };

ob_paper_plan ob_paper_plan_full(void)
{
	return (ob_paper_plan){ 64, PAPER_EXPERIMENTS, 2.5, 1, sizeof full_sizes / sizeof *full_sizes, full_sizes, 3 };
}

ob_paper_plan ob_paper_plan_quick(void)
{
	return (ob_paper_plan){ 12, 2, .3, .2, sizeof quick_sizes / sizeof *quick_sizes, quick_sizes, 1 };
}

typedef struct journey {
	const ob_paper_plan *plan;
	ob_paper_tick *tick;
	ob_paper_results *results;
	size_t done, all, ran;
	double begun;
	ob_error last; // of the runs that failed
} journey;

static void tell(const journey *j, const ob_paper_trial *t)
{
	char what[96];
	snprintf(what, sizeof what, "%s, %u boxes", ob_paper_setups[t->scenario].title, t->objects);
	double each = j->done ? (ob_clock_wall() - j->begun) / (double)j->done : NAN;
	if (j->tick)
		j->tick(j->done, j->all, each * (double)(j->all - j->done), what);
}

static bool attempt(journey *j, const ob_paper_trial *t, ob_paper_sample s, ob_error *e)
{
	bool interrupted;
	ob_error why;
	tell(j, t);
	bool fine = ob_paper_attempt(t, &s, &interrupted, &why);
	if (interrupted)
		return ob_fail(e, "interrupted");
	j->done++;
	j->ran += fine;
	if (!fine) {
		snprintf(s.failed, sizeof s.failed, "%.159s", why.text);
		j->last = why;
	} else if (why.text[0]) {
		snprintf(j->results->no_frames, sizeof j->results->no_frames, "%.199s", why.text);
	}
	return ob_paper_results_add(j->results, &s) || ob_fail(e, "out of memory");
}

static bool run_experiment(journey *j, uint32_t k, ob_error *e)
{
	const ob_paper_plan *p = j->plan;
	for (uint32_t i = 0; i < OB_PAPER_SCENARIOS; i++) {
		ob_paper_trial t = { (i + k) % OB_PAPER_SCENARIOS, p->objects, k + 1, p->alone_s, p->watched_s };
		ob_paper_sample s = ob_paper_sample_unmeasured();
		s.scenario = t.scenario;
		s.experiment = k;
		s.objects = t.objects;
		s.seed = t.seed;
		if (!attempt(j, &t, s, e))
			return false;
	}
	return true;
}

// Sizes in an order that is not that of time: a machine that becomes slower does not look like growth.
static bool run_growth(journey *j, uint32_t repeat, ob_error *e)
{
	const ob_paper_plan *p = j->plan;
	for (uint32_t i = 0; i < p->sizes * GROWING; i++) {
		uint32_t at = (i / GROWING * 5 + repeat) % (uint32_t)p->sizes;
		ob_paper_trial t = { growing[(i + repeat) % GROWING], p->size[at], repeat + 1, p->alone_s, 0 };
		ob_paper_sample s = ob_paper_sample_unmeasured();
		s.scenario = t.scenario;
		s.growth = true;
		s.experiment = repeat;
		s.objects = t.objects;
		s.seed = t.seed;
		if (!attempt(j, &t, s, e))
			return false;
	}
	return true;
}

static double time_sum(void)
{
	double begun = ob_clock_thread_cpu();
	for (int i = 0; i < SUMS; i++)
		ob_synthetic_load(ob_paper_setups[OB_PAPER_COMMON_LOAD].load);
	return (ob_clock_thread_cpu() - begun) / SUMS;
}

bool ob_paper_run(const ob_paper_plan *p, ob_paper_tick *tick, ob_paper_results *r, ob_error *e)
{
	journey j = {
		.plan = p,
		.tick = tick,
		.results = r,
		.begun = ob_clock_wall(),
		.all = (size_t)p->experiments * OB_PAPER_SCENARIOS + p->sizes * GROWING * p->repeats,
	};
	r->objects = p->objects;
	r->experiments = p->experiments;
	r->sum_s = time_sum();
	if (getloadavg(&r->busy, 1) != 1)
		r->busy = NAN;
	for (uint32_t k = 0; k < p->experiments; k++)
		if (!run_experiment(&j, k, e))
			return false;
	for (uint32_t k = 0; k < p->repeats; k++)
		if (!run_growth(&j, k, e))
			return false;
	return j.ran > 0 || ob_fail(e, "%s", j.last.text);
}
