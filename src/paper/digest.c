#include "paper/digest.h"

#include <math.h>

enum { GROWTH_MAX = 256, PREFERENCE_LEAST = 8 }; // runs, so that a preference means something
static const double odds = 10;

#define QUANTITY(member) offsetof(ob_paper_sample, member)
const ob_paper_quantity_def ob_paper_quantities[OB_PAPER_QUANTITIES] = {
	[OB_PAPER_STEP] = { "step_s", "step, until the last is done", "ms", 1e3, QUANTITY(step_s) },
	[OB_PAPER_TOTAL] = { "total_cpu_s", "CPU of all simulators in a step", "ms", 1e3, QUANTITY(total_s) },
	[OB_PAPER_ONE] = { "cpu_per_simulator_s", "CPU of one simulator in a step", "ms", 1e3, QUANTITY(one_s) },
	[OB_PAPER_BUSIEST] = { "busiest_cpu_s", "CPU of the busiest in a step", "ms", 1e3, QUANTITY(busiest_s) },
	[OB_PAPER_CPU] = { "cpu_share", "CPU of all simulators, of one core", "%", 100, QUANTITY(cpu) },
	[OB_PAPER_DEMAND] = { "cpu_per_simulated_s", "CPU of all simulators by simulated time, of one core", "%", 100,
			      QUANTITY(demand) },
	[OB_PAPER_PACE] = { "pace", "simulated time by real time", "%", 100, QUANTITY(pace) },
	[OB_PAPER_FPS] = { "fps", "frames drawn", "1/s", 1, QUANTITY(fps) },
	[OB_PAPER_VIEWER] = { "viewer_cpu_share", "CPU of viewer and host, of one core", "%", 100,
			      QUANTITY(viewer_cpu) },
	[OB_PAPER_TESTS] = { "box_tests", "tests of two boxes in a step", "1", 1, QUANTITY(box_tests) },
	[OB_PAPER_MEMORY] = { "memory_bytes", "memory", "MB", 1e-6, QUANTITY(memory_bytes) },
};

double ob_paper_value(const ob_paper_sample *s, ob_paper_quantity q)
{
	return *(const double *)((const char *)s + ob_paper_quantities[q].offset);
}

const ob_paper_sample *ob_paper_find(const ob_paper_results *r, ob_paper_scenario s, uint32_t experiment)
{
	for (size_t i = 0; i < r->count; i++) {
		const ob_paper_sample *at = &r->sample[i];
		if (!at->growth && !at->failed[0] && at->scenario == s && at->experiment == experiment)
			return at;
	}
	return NULL;
}

ob_statistics ob_paper_summarise(const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q)
{
	double x[OB_PAPER_EXPERIMENTS_MAX];
	size_t n = 0;
	for (uint32_t k = 0; k < OB_PAPER_EXPERIMENTS_MAX; k++) {
		const ob_paper_sample *at = ob_paper_find(r, s, k);
		if (at && isfinite(ob_paper_value(at, q)))
			x[n++] = ob_paper_value(at, q);
	}
	return ob_reference_summarise(n, x);
}

ob_paper_ratio ob_paper_compare(const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b,
				ob_paper_quantity q)
{
	double x[OB_PAPER_EXPERIMENTS_MAX];
	size_t n = 0;
	for (uint32_t k = 0; k < OB_PAPER_EXPERIMENTS_MAX; k++) {
		const ob_paper_sample *one = ob_paper_find(r, a, k), *other = ob_paper_find(r, b, k);
		double ratio = one && other ? ob_paper_value(one, q) / ob_paper_value(other, q) : NAN;
		if (isfinite(ratio) && ratio > 0)
			x[n++] = log(ratio);
	}
	ob_statistics s = ob_reference_summarise(n, x);
	return (ob_paper_ratio){ n, exp(s.mean), exp(s.mean_low), exp(s.mean_high) };
}

ob_paper_growth ob_paper_grow(const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q)
{
	double objects[GROWTH_MAX], log_objects[GROWTH_MAX], y[GROWTH_MAX], log_y[GROWTH_MAX];
	size_t n = 0;
	for (size_t i = 0; i < r->count && n < GROWTH_MAX; i++) {
		const ob_paper_sample *at = &r->sample[i];
		double v = ob_paper_value(at, q);
		if (!at->growth || at->failed[0] || at->scenario != s || !isfinite(v) || v <= 0)
			continue;
		objects[n] = at->objects;
		log_objects[n] = log(at->objects);
		y[n] = v;
		log_y[n++] = log(v);
	}
	ob_paper_growth g = {
		.linear = ob_reference_line(n, objects, y),
		.logarithmic = ob_reference_line(n, log_objects, y),
		.power = ob_reference_line(n, log_objects, log_y),
	};
	// As many parameters in both: of Akaike's criterion, the logarithm of the squares remains. Squares that are
	// nothing but rounding prove no more than others of that size.
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
