// Made-up results, with known conclusions.
#ifndef OB_TESTS_PAPER_MADE_H
#define OB_TESTS_PAPER_MADE_H

#include "paper/results.h"

enum { MADE_EXPERIMENTS = 15, MADE_SIZES = 6, MADE_REPEATS = 3 };

// Record without measurements.
ob_record made_record(ob_paper_scenario s, bool growth, uint32_t objects, uint32_t repeat);
// All scenarios alike: a step and CPU time of 1 ms, 6 % of a core, 100 frames, in time; 1 % of scatter. The caller
// frees its records.
ob_paper_results made_alike(void);
// Multiplies a metric of a scenario, in the experiments.
void made_scale(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double factor);
// Sets another scatter, as a share of the value.
void made_scatter(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double share);
// Adds runs with 8 to 256 objects. Their metrics are all of(objects) with 1 % of scatter, or their own (set_growth).
void made_growth(ob_paper_results *r, ob_paper_scenario s, double (*of)(double objects));
void made_set_growth(ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m, double (*of)(double objects));

#endif
