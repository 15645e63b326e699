#include "paper/paper.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "paper/trial.h"
#include "ranks/ranks.h"

enum { PAPER_EXPERIMENTS = 15, GROWING = 2, SUMS = 20000 };

static const uint32_t full_sizes[] = { 8, 16, 32, 64, 128, 256 }, quick_sizes[] = { 4, 8, 16 };
static const ob_paper_scenario growing[GROWING] = { OB_PAPER_COMMON, OB_PAPER_OBS };
static const double start_s = .4; // overhead of starting and ending
static const double limit_s = 300; // CPU of a trial: many times the largest

ob_paper_plan ob_paper_plan_full(void)
{
	return (ob_paper_plan){ 64, PAPER_EXPERIMENTS, 2.5, 1, sizeof full_sizes / sizeof *full_sizes, full_sizes, 3 };
}

ob_paper_plan ob_paper_plan_quick(void)
{
	return (ob_paper_plan){ 12, 2, .3, .2, sizeof quick_sizes / sizeof *quick_sizes, quick_sizes, 1 };
}

static bool run_trial(const ob_trial *t, ob_record *out, ob_error *e)
{
	const ob_paper_plan *p = t->what;
	uint32_t objects;
	bool growth = ob_paper_is_growth(t->of, &objects);
	ob_paper_trial one = { ob_paper_scenario_of(out), objects, t->seed, p->alone_s, growth ? 0 : p->watched_s };
	bool fine = ob_paper_trial_run(&one, out->metric, e);
	if (fine && *e->text) // no frame was drawn
		snprintf(out->note, sizeof out->note, "%.63s", e->text);
	return fine;
}

static const char *const columns[] = { "series", "objects" };

static void describe(const ob_record *r, size_t column, char *to, size_t room)
{
	uint32_t objects;
	bool growth = ob_paper_is_growth(r->of, &objects);
	if (column == 0)
		snprintf(to, room, "%s", growth ? "growth" : "experiment");
	else
		snprintf(to, room, "%u", objects);
}

ob_experiment ob_paper_experiment(const char *commit)
{
	return (ob_experiment){ .name = "paper",
				.commit = commit,
				.metrics = OB_PAPER_METRICS,
				.metric = ob_paper_metrics,
				.run = run_trial,
				.limit_s = limit_s,
				.columns = sizeof columns / sizeof *columns,
				.column = columns,
				.describe = describe };
}

static bool add_trial(const ob_paper_plan *p, ob_trials *s, bool growth, uint32_t objects, ob_paper_scenario scenario,
		      uint32_t repeat)
{
	ob_trial t = { .repeat = repeat,
		       .seed = repeat + 1,
		       .guess_s = start_s + p->alone_s + (growth ? 0 : p->watched_s),
		       .what = p };
	ob_paper_case_key(t.of, growth, objects);
	snprintf(t.configuration, sizeof t.configuration, "%s", ob_paper_setups[scenario].key);
	return ob_trials_add(s, &t);
}

bool ob_paper_schedule(const ob_paper_plan *p, ob_trials *s, ob_error *e)
{
	const size_t from = s->count;
	bool fine = true;
	for (int scenario = 0; fine && scenario < OB_PAPER_SCENARIOS; scenario++)
		fine = add_trial(p, s, false, p->objects, scenario, 0);
	fine = fine && ob_trials_repeat(s, from, p->experiments, OB_ORDER_ROTATED, true);
	// Shuffles the sizes in time, so that a machine that slows down does not look like growth.
	for (uint32_t repeat = 0; repeat < p->repeats; repeat++)
		for (uint32_t i = 0; fine && i < p->sizes * GROWING; i++) {
			uint32_t at = (i / GROWING * 5 + repeat) % (uint32_t)p->sizes;
			fine = add_trial(p, s, true, p->size[at], growing[(i + repeat) % GROWING], repeat);
		}
	return fine || ob_fail(e, "out of memory");
}

static double time_sum(void)
{
	double begun = ob_clock_thread_cpu();
	for (int i = 0; i < SUMS; i++)
		ob_synthetic_load(ob_paper_setups[OB_PAPER_COMMON_LOAD].load);
	return (ob_clock_thread_cpu() - begun) / SUMS;
}

static bool has_outcome(const ob_records *r, ob_error *e)
{
	for (size_t i = 0; i < r->count; i++)
		if (!r->record[i].failure)
			return true;
	return ob_fail(e, "%s", r->count ? r->record[r->count - 1].reason : "nothing was run");
}

bool ob_paper_run(const ob_paper_plan *p, const char *commit, const char *folder, bool fresh, ob_paper_results *r,
		  ob_error *e)
{
	const ob_experiment x = ob_paper_experiment(commit);
	ob_trials trials = { 0 };
	*r = (ob_paper_results){ .objects = p->objects, .experiments = p->experiments, .sum_s = time_sum() };
	if (getloadavg(&r->busy, 1) != 1)
		r->busy = NAN;
	bool fine = ob_paper_schedule(p, &trials, e) && ob_experiment_open(&x, folder, &r->records, e);
	if (fine && fresh)
		ob_records_drop(&r->records, &trials);
	fine = fine && ob_experiment_run(&x, &trials, &r->records, folder, e) &&
	       (ob_ranks_started().rank > 0 || has_outcome(&r->records, e));
	ob_trials_finish(&trials);
	return fine;
}
