#include "paper/results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PAPER_LOAD = 1000, PUBLISHED = 15 };
enum { GROWTH_MAX = 256, PREFERENCE_LEAST = 8 }; // runs needed for a meaningful preference
static const double odds = 10;
static const char growth_prefix[] = "growth-", experiment_prefix[] = "experiment-";

const ob_paper_setup ob_paper_setups[OB_PAPER_SCENARIOS] = {
	[OB_PAPER_COMMON] = { "common", "common", "one simulator: one ODE world that holds all objects",
			      .monolith = true },
	[OB_PAPER_COMMON_LOAD] = { "common_load", "common, load",
				   "the same, and 1 to 1000 added up in each test of two boxes", .monolith = true,
				   .load = PAPER_LOAD },
	[OB_PAPER_OBS] = { "obs", "OBS",
			   "a simulator for each object, each a process of its own that waits for no other",
			   .each = true, .free = true },
	[OB_PAPER_OBS_LOAD] = { "obs_load", "OBS, load", "the same, and 1 to 1000 added up in each test of two boxes",
				.each = true, .free = true, .load = PAPER_LOAD },
	[OB_PAPER_OBS_OBB] = { "obs_obb", "OBS, OBB", "OBS, and objects touch where their true, turned shapes do",
			       .each = true, .free = true, .oriented = true },
	[OB_PAPER_COMMON_OBB] = { "common_obb", "common, OBB",
				  "one ODE world, and objects touch where their true shapes do", .monolith = true,
				  .oriented = true },
	[OB_PAPER_POOL] = { "pool", "OBS, pool",
			    "a simulator for each object, all of them run in lockstep by one thread per core",
			    .each = false },
	[OB_PAPER_LOCKSTEP] = { "obs_lockstep", "OBS, lockstep",
				"a process for each object, and all wait for each other after each step",
				.each = true },
};

#define METRIC(key, title, unit, scale) \
	{ \
		key, title, unit, scale, NAN, NULL, title \
	}
const ob_metric ob_paper_metrics[OB_PAPER_METRICS] = {
	[OB_PAPER_STEP] = METRIC("step_s", "step, until the last is done", "ms", 1e3),
	[OB_PAPER_TOTAL] = METRIC("total_cpu_s", "CPU of all simulators in a step", "ms", 1e3),
	[OB_PAPER_ONE] = METRIC("cpu_per_simulator_s", "CPU of one simulator in a step", "ms", 1e3),
	[OB_PAPER_BUSIEST] = METRIC("busiest_cpu_s", "CPU of the busiest in a step", "ms", 1e3),
	[OB_PAPER_CPU] = METRIC("cpu_share", "CPU of all simulators, of one core", "%", 100),
	[OB_PAPER_DEMAND] =
		METRIC("cpu_per_simulated_s", "CPU of all simulators by simulated time, of one core", "%", 100),
	[OB_PAPER_PACE] = METRIC("pace", "simulated time by real time", "%", 100),
	[OB_PAPER_FPS] = METRIC("fps", "frames drawn", "1/s", 1),
	[OB_PAPER_VIEWER] = METRIC("viewer_cpu_share", "CPU of viewer and host, of one core", "%", 100),
	[OB_PAPER_TESTS] = METRIC("box_tests", "tests of two boxes in a step", "1", 1),
	[OB_PAPER_MEMORY] = METRIC("memory_bytes", "memory", "MB", 1e-6),
};

void ob_paper_case_key(char key[OB_CASE_KEY], bool growth, uint32_t objects)
{
	snprintf(key, OB_CASE_KEY, "%s%u", growth ? growth_prefix : experiment_prefix, objects);
}

bool ob_paper_is_growth(const char *of, uint32_t *objects)
{
	const char *number = strrchr(of, '-');
	*objects = number ? (uint32_t)strtoul(number + 1, NULL, 10) : 0;
	return strncmp(of, growth_prefix, sizeof growth_prefix - 1) == 0;
}

ob_paper_scenario ob_paper_scenario_of(const ob_record *r)
{
	int s = 0;
	while (s < OB_PAPER_SCENARIOS && strcmp(r->configuration, ob_paper_setups[s].key) != 0)
		s++;
	return s;
}

// Tables 1 to 5 of the paper: runtime (s), frame rate (1/s), CPU usage (%)
static const struct {
	ob_paper_scenario scenario;
	double row[PUBLISHED][3];
} published[] = {
	{ OB_PAPER_COMMON,
	  { { .008, 240, 49.52 },
	    { .009, 240, 49.65 },
	    { .008, 230, 50.01 },
	    { .010, 240, 49.3 },
	    { .006, 230, 49.8 },
	    { .005, 230, 50.57 },
	    { .008, 240, 49.45 },
	    { .005, 230, 49.7 },
	    { .005, 230, 50.2 },
	    { .006, 230, 50.8 },
	    { .008, 240, 50.33 },
	    { .005, 230, 50.47 },
	    { .005, 230, 51.3 },
	    { .006, 230, 51.76 },
	    { .005, 230, 51.38 } } },
	{ OB_PAPER_COMMON_LOAD,
	  { { .040, 150, 53.22 },
	    { .040, 150, 51.95 },
	    { .050, 160, 53.38 },
	    { .048, 160, 50.89 },
	    { .050, 155, 51.14 },
	    { .060, 160, 52.73 },
	    { .050, 160, 52.64 },
	    { .043, 150, 50.32 },
	    { .040, 150, 51.87 },
	    { .040, 150, 52.36 },
	    { .050, 150, 53.29 },
	    { .050, 150, 52.96 },
	    { .040, 150, 52.78 },
	    { .040, 155, 52.83 },
	    { .040, 150, 52.62 } } },
	{ OB_PAPER_OBS,
	  { { .001, 240, 20.58 },
	    { .001, 240, 20.23 },
	    { .001, 240, 20.92 },
	    { .002, 240, 21.18 },
	    { .001, 236, 20.20 },
	    { .001, 240, 20.84 },
	    { .001, 240, 20.65 },
	    { .001, 236, 21.72 },
	    { .001, 240, 21.49 },
	    { .001, 240, 20.96 },
	    { .001, 240, 21.10 },
	    { .001, 240, 20.32 },
	    { .001, 240, 20.80 },
	    { .001, 240, 21.38 },
	    { .001, 240, 21.75 } } },
};

ob_paper_results ob_paper_published(void)
{
	ob_paper_results r = { .experiments = PUBLISHED };
	for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
		for (uint32_t k = 0; k < PUBLISHED; k++) {
			ob_record one = { .repeat = k, .seed = k + 1 };
			ob_paper_case_key(one.of, false, r.objects);
			snprintf(one.configuration, sizeof one.configuration, "%s",
				 ob_paper_setups[published[i].scenario].key);
			for (int m = 0; m < OB_PAPER_METRICS; m++)
				one.metric[m] = NAN;
			one.metric[OB_PAPER_STEP] = published[i].row[k][0];
			one.metric[OB_PAPER_FPS] = published[i].row[k][1];
			one.metric[OB_PAPER_CPU] = published[i].row[k][2] / 100;
			if (!ob_records_add(&r.records, &one))
				return r;
		}
	}
	return r;
}

const ob_record *ob_paper_find(const ob_paper_results *r, ob_paper_scenario s, uint32_t experiment)
{
	char of[OB_CASE_KEY];
	ob_paper_case_key(of, false, r->objects);
	const ob_record *found = ob_records_find(&r->records, of, ob_paper_setups[s].key, experiment, experiment + 1);
	return found && !found->failure ? found : NULL;
}

ob_statistics ob_paper_summarise(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m)
{
	char of[OB_CASE_KEY];
	ob_paper_case_key(of, false, r->objects);
	return ob_records_summarise(&r->records, of, ob_paper_setups[s].key, m);
}

ob_estimate ob_paper_compare(const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b, ob_paper_metric m)
{
	char of[OB_CASE_KEY];
	ob_paper_case_key(of, false, r->objects);
	ob_statistics s = ob_records_ratio(&r->records, of, ob_paper_setups[a].key, ob_paper_setups[b].key, m, true);
	return (ob_estimate){ s.n, exp(s.mean), exp(s.mean_low), exp(s.mean_high), s.n > 1 };
}

ob_paper_growth ob_paper_grow(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m)
{
	double objects[GROWTH_MAX], log_objects[GROWTH_MAX], y[GROWTH_MAX], log_y[GROWTH_MAX];
	size_t n = 0;
	for (size_t i = 0; i < r->records.count && n < GROWTH_MAX; i++) {
		const ob_record *at = &r->records.record[i];
		double v = at->metric[m];
		uint32_t count;
		if (!ob_paper_is_growth(at->of, &count) || at->failure || ob_paper_scenario_of(at) != s ||
		    !isfinite(v) || v <= 0)
			continue;
		objects[n] = count;
		log_objects[n] = log(count);
		y[n] = v;
		log_y[n++] = log(v);
	}
	ob_paper_growth g = {
		.linear = ob_reference_line(n, objects, y),
		.logarithmic = ob_reference_line(n, log_objects, y),
		.power = ob_reference_line(n, log_objects, log_y),
	};
	// Both models have as many parameters, so Akaike's criterion reduces to the logarithm of the squares. Squares
	// at the level of rounding do not distinguish the models.
	double floor = 1e-24 * (double)n * pow(g.linear.mean_y, 2);
	g.favour = .5 * (double)n * log((g.logarithmic.squares + floor) / (g.linear.squares + floor));
	return g;
}

int ob_paper_prefers(const ob_paper_growth *g)
{
	if (g->linear.n < PREFERENCE_LEAST)
		return 0;
	return g->favour > log(odds) ? 1 : g->favour < -log(odds) ? -1 : 0;
}
