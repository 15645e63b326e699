// One experiment: boxes fall in a universe that runs in real time, not faster. The simulators are measured first,
// without a viewer; then a viewer draws, and its frames are counted.
#ifndef OB_PAPER_TRIAL_H
#define OB_PAPER_TRIAL_H

#include <ob/error.h>

#include "paper/results.h"

typedef struct ob_paper_trial {
	ob_paper_scenario scenario;
	uint32_t objects;
	uint64_t seed;
	double alone_s, watched_s; // real time without and with a viewer; watched 0 = no viewer
} ob_paper_trial;

// Constants of all trials.
#define OB_PAPER_STEP_LENGTH (1 / 60.) // s
enum { OB_PAPER_SUBSTEPS = 1, OB_PAPER_ITERATIONS = 20 }; // a step; iterations of the solver, at most

// Fills the metrics. e: reason of a failure, or (true) of missing frames; otherwise "". Forks, maps shared memory and
// starts threads: call it in a process of its own.
bool ob_paper_trial_run(const ob_paper_trial *t, double metric[OB_PAPER_METRICS], ob_error *e);

#endif
