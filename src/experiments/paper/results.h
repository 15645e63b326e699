// Measured results and their statistics: means, ratios of pairs of runs, growth with the number of objects, with 95 %
// confidence intervals. Pure functions.
#ifndef OB_PAPER_RESULTS_H
#define OB_PAPER_RESULTS_H

#include "experiment/analysis.h"

typedef enum ob_paper_scenario {
	OB_PAPER_COMMON, // the paper's scenario 1
	OB_PAPER_COMMON_LOAD, // with the added work
	OB_PAPER_OBS, // the paper's scenario 2
	OB_PAPER_OBS_LOAD, // from here on: scenarios that the paper never ran
	OB_PAPER_OBS_OBB,
	OB_PAPER_COMMON_OBB,
	OB_PAPER_POOL,
	OB_PAPER_LOCKSTEP, // of OBS
	OB_PAPER_SCENARIOS
} ob_paper_scenario;

typedef struct ob_paper_setup {
	const char *key, *title; // the configuration of its records; for people
	const char *what; // way of running it
	bool monolith, each; // one world; one process per object; neither (OBS): a pool of threads
	bool oriented; // true shapes; otherwise axis-aligned boxes
	bool free; // simulators at times of their own, each with its own response; otherwise in lockstep
	uint32_t load; // numbers added up in each test of two boxes
} ob_paper_setup;

extern const ob_paper_setup ob_paper_setups[OB_PAPER_SCENARIOS];

typedef enum ob_paper_metric {
	OB_PAPER_STEP, // wall time of a step: until the last simulator is done
	OB_PAPER_TOTAL, // CPU of all simulators in a step
	OB_PAPER_ONE, // same divided by the number of simulators
	OB_PAPER_BUSIEST, // CPU of the busiest worker in a step
	OB_PAPER_CPU, // CPU of all simulators by wall time: 1 = one core
	OB_PAPER_DEMAND, // by simulated time
	OB_PAPER_PACE, // simulated time by wall time: 1 = real time, the maximum
	OB_PAPER_FPS, // frames actually drawn, by wall time
	OB_PAPER_VIEWER, // CPU of the viewer and the host by wall time, while frames are drawn
	OB_PAPER_TESTS, // tests of two boxes in a step
	OB_PAPER_MEMORY,
	OB_PAPER_METRICS
} ob_paper_metric;

extern const ob_metric ob_paper_metrics[OB_PAPER_METRICS];

// Records of two kinds of cases: experiments with the same number of boxes (repeat k has boxes of seed k + 1), and a
// series with growing numbers. A record without frames has the reason in its note.
typedef struct ob_paper_results {
	ob_records records;
	uint32_t objects, experiments; // as planned
	double busy; // load average of the machine before the first run: 1 = other programs kept one core busy
	double sum_s; // CPU time of one addition of 1 to 1000
} ob_paper_results;

enum { OB_PAPER_EXPERIMENTS_MAX = 64 };

// Case key of so many boxes, in the experiments or in the series.
void ob_paper_case_key(char key[OB_CASE_KEY], bool growth, uint32_t objects);
// Parses a case key. objects: number of boxes
bool ob_paper_is_growth(const char *of, uint32_t *objects);
ob_paper_scenario ob_paper_scenario_of(const ob_record *r); // OB_PAPER_SCENARIOS = none

// The three tables of the paper's own runs (Elfizar et al.): runtime as OB_PAPER_STEP, frame rate, CPU. The caller
// frees its records. Empty if memory runs out.
ob_paper_results ob_paper_published(void);

// Finds a record of the experiments. NULL: missing, or failed.
const ob_record *ob_paper_find(const ob_paper_results *r, ob_paper_scenario s, uint32_t experiment);
// Statistics over the experiments that measured it without failure.
ob_statistics ob_paper_summarise(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m);

// Ratio a over b, from pairs of the same experiment: geometric mean, interval by Student on the logarithms.
ob_estimate ob_paper_compare(const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b, ob_paper_metric m);

typedef struct ob_paper_growth {
	ob_line linear, logarithmic; // value over n, value over ln n
	ob_line power; // ln value over ln n: the slope is the exponent
	double favour; // log-likelihood ratio of the line and the logarithm (natural logarithm, Akaike 1974)
} ob_paper_growth;

ob_paper_growth ob_paper_grow(const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m);
// Model preferred by odds of ten to one: 1 the line, -1 the logarithm, 0 neither (or too few runs)
int ob_paper_prefers(const ob_paper_growth *g);

#endif
