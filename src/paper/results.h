// What was measured, and what it says together: means, ratios of pairs of runs, growth with the number of objects; with
// confidence intervals of 95 %. Pure functions.
#ifndef OB_PAPER_RESULTS_H
#define OB_PAPER_RESULTS_H

#include "experiment/analysis.h"

typedef enum ob_paper_scenario {
	OB_PAPER_COMMON, // the paper's scenario 1
	OB_PAPER_COMMON_LOAD, // with the added work
	OB_PAPER_OBS, // the paper's scenario 2
	OB_PAPER_OBS_LOAD, // from here on: what the paper never ran
	OB_PAPER_OBS_OBB,
	OB_PAPER_COMMON_OBB,
	OB_PAPER_POOL,
	OB_PAPER_SCENARIOS
} ob_paper_scenario;

typedef struct ob_paper_setup {
	const char *key, *title; // the configuration of its records; for people
	const char *what; // how it is run
	bool monolith, each; // one world; one process per object, else (of OBS) a pool of threads
	bool oriented; // true shapes, else axis-aligned boxes
	uint32_t load; // numbers added up in each test of two boxes
} ob_paper_setup;

extern const ob_paper_setup ob_paper_setups[OB_PAPER_SCENARIOS];

typedef enum ob_paper_metric {
	OB_PAPER_STEP, // wall time of a step: until the last simulator is done
	OB_PAPER_TOTAL, // CPU of all simulators in a step
	OB_PAPER_ONE, // the same divided by the number of simulators
	OB_PAPER_BUSIEST, // CPU of the busiest worker in a step
	OB_PAPER_CPU, // CPU of all simulators by wall time: 1 = one core
	OB_PAPER_DEMAND, // by simulated time
	OB_PAPER_PACE, // simulated time by wall time: 1 = as fast as reality, which is the most
	OB_PAPER_FPS, // frames that were really drawn, by wall time
	OB_PAPER_VIEWER, // CPU of the viewer and the host by wall time, while frames are drawn
	OB_PAPER_TESTS, // of two boxes, in a step
	OB_PAPER_MEMORY,
	OB_PAPER_METRICS
} ob_paper_metric;

extern const ob_metric ob_paper_metrics[OB_PAPER_METRICS];

// Records of two kinds of cases: experiments with the same number of boxes (repeat k has boxes of seed k + 1), and a
// series with more and more boxes. The note of a record says why it drew no frames.
typedef struct ob_paper_results {
	ob_records records;
	uint32_t objects, experiments; // as planned
	double busy; // load average of the machine before the first run: 1 = something else kept one core busy
	double sum_s; // CPU time of adding up 1 to 1000 by itself
} ob_paper_results;

enum { OB_PAPER_EXPERIMENTS_MAX = 64 };

// The case of so many boxes, in the experiments or in the series
void ob_paper_case_key(char key[OB_CASE_KEY], bool growth, uint32_t objects);
// What a case key says. objects: how many boxes
bool ob_paper_is_growth(const char *of, uint32_t *objects);
ob_paper_scenario ob_paper_scenario_of(const ob_record *r); // OB_PAPER_SCENARIOS = none

// The three tables that the paper prints of its own runs (Elfizar et al.): runtime as OB_PAPER_STEP, frame rate, CPU.
// The caller frees its records. Empty if there is no memory.
ob_paper_results ob_paper_published(void);

// Of the experiments. NULL: it is not there, or failed.
const ob_record *ob_paper_find(const ob_paper_results *r, ob_paper_scenario s, uint32_t experiment);
// Over the experiments that did not fail and measured it
ob_statistics ob_paper_summarise(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m);

typedef struct ob_paper_ratio {
	size_t n; // pairs
	double mean, low, high; // NaN: unknown
} ob_paper_ratio;

// a over b, pairs of the same experiment: geometric mean, interval by Student on the logarithms
ob_paper_ratio ob_paper_compare(const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b, ob_paper_metric m);

typedef struct ob_paper_growth {
	ob_line linear, logarithmic; // value over n, value over ln n
	ob_line power; // ln value over ln n: the slope is the exponent
	double favour; // how much likelier the line is than the logarithm, as a natural logarithm (Akaike 1974)
} ob_paper_growth;

ob_paper_growth ob_paper_grow(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m);
// What the data prefer, by odds of ten to one: 1 the line, -1 the logarithm, 0 neither (or too few runs)
int ob_paper_prefers(const ob_paper_growth *g);

#endif
