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

#define METRIC(k, t, u, s) \
	{ \
		.key = k, .title = t, .unit = u, .scale = s, .target = NAN, .meaning = t \
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

// Tables 1 to 5 of the paper: by experiment
static const struct {
	ob_paper_scenario scenario;
	double runtime_s[PUBLISHED], fps[PUBLISHED], cpu_percent[PUBLISHED];
} published[] = {
	{ OB_PAPER_COMMON,
	  { .008, .009, .008, .010, .006, .005, .008, .005, .005, .006, .008, .005, .005, .006, .005 },
	  { 240, 240, 230, 240, 230, 230, 240, 230, 230, 230, 240, 230, 230, 230, 230 },
	  { 49.52, 49.65, 50.01, 49.3, 49.8, 50.57, 49.45, 49.7, 50.2, 50.8, 50.33, 50.47, 51.3, 51.76, 51.38 } },
	{ OB_PAPER_COMMON_LOAD,
	  { .040, .040, .050, .048, .050, .060, .050, .043, .040, .040, .050, .050, .040, .040, .040 },
	  { 150, 150, 160, 160, 155, 160, 160, 150, 150, 150, 150, 150, 150, 155, 150 },
	  { 53.22, 51.95, 53.38, 50.89, 51.14, 52.73, 52.64, 50.32, 51.87, 52.36, 53.29, 52.96, 52.78, 52.83, 52.62 } },
	{ OB_PAPER_OBS,
	  { .001, .001, .001, .002, .001, .001, .001, .001, .001, .001, .001, .001, .001, .001, .001 },
	  { 240, 240, 240, 240, 236, 240, 240, 236, 240, 240, 240, 240, 240, 240, 240 },
	  { 20.58, 20.23, 20.92, 21.18, 20.20, 20.84, 20.65, 21.72, 21.49, 20.96, 21.10, 20.32, 20.80, 21.38, 21.75 } },
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
			one.metric[OB_PAPER_STEP] = published[i].runtime_s[k];
			one.metric[OB_PAPER_FPS] = published[i].fps[k];
			one.metric[OB_PAPER_CPU] = published[i].cpu_percent[k] / 100;
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
		.linear = ob_statistics_line(n, objects, y),
		.logarithmic = ob_statistics_line(n, log_objects, y),
		.power = ob_statistics_line(n, log_objects, log_y),
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
