// Results of the lab: one per case, engine and setting.
#ifndef OB_LAB_RESULT_H
#define OB_LAB_RESULT_H

#include "lab/case.h"

enum { OB_REPEATS = 15 }; // at most

typedef struct ob_result {
	const ob_case *of;
	const ob_engine_kind *engine;
	ob_run_settings settings;
	ob_case_result outcome; // medians of the repeats' times, and the worst of their figures
	uint32_t repeats;
	double cpu_s[OB_REPEATS], wall_s[OB_REPEATS]; // of each repeat
} ob_result;

typedef struct ob_results {
	size_t count, max;
	ob_result *result; // in the order of cases, engines, settings
	char machine[192]; // processor, cores, kernel
	char commit[64];
} ob_results;

// CPU seconds per body and simulated second.
static inline double ob_result_cost(const ob_result *r)
{
	return r->outcome.cpu_s / r->outcome.body_seconds;
}

// Orders by case, engine and setting, from coarse to fine; < 0, 0 or > 0
int ob_result_order(const ob_result *a, const ob_result *b);
ob_result *ob_results_find(const ob_results *r, const ob_case *c, const ob_engine_kind *k, const ob_run_settings *s);
bool ob_results_add(ob_results *r, const ob_result *one); // in order; false: out of memory
// Adds one more repeat: updates medians and worst figures. No effect if there are OB_REPEATS already.
void ob_result_repeat(ob_result *r, const ob_case_result *again);
void ob_results_finish(ob_results *r);

// Cheapest cost (s of CPU per body and simulated second) at which an engine keeps figure 0 of a case at or below
// "error" (ob_cost_at_error). NAN: never.
double ob_cost_at(const ob_results *r, const ob_case *c, const ob_engine_kind *k, double error);

#endif
