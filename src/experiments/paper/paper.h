// Repeats the paper's experiment (Elfizar et al., "Implementation of Enhanced Axis Aligned Bounding Box for Object
// Collision Detection in Distributed Virtual Environment"), with its measurements and those that it left out.
#ifndef OB_PAPER_PAPER_H
#define OB_PAPER_PAPER_H

#include <ob/error.h>

#include "experiment/experiment.h"
#include "paper/results.h"

typedef struct ob_paper_plan {
	uint32_t objects, experiments; // boxes in each experiment; number of experiments, each with other boxes
	double alone_s, watched_s; // as in ob_paper_trial
	size_t sizes; // series with growing numbers of objects
	const uint32_t *size;
	uint32_t repeats; // of each size
} ob_paper_plan;

ob_paper_plan ob_paper_plan_full(void); // the paper's 15 experiments: about ten minutes
ob_paper_plan ob_paper_plan_quick(void); // test run: its figures have little significance

ob_experiment ob_paper_experiment(const char *commit);
// Schedules the trials; no scenario is always first. The plan must outlive them. Returns false and e if memory runs
// out.
bool ob_paper_schedule(const ob_paper_plan *p, ob_trials *s, ob_error *e);

// Runs the trials missing in the folder's results.csv; fresh: all. Returns false and e if interrupted, if memory runs
// out, or if nothing could be run at all. On several ranks: as ob_experiment_run. Starts processes; call it from a
// process without other threads. The caller frees r->records.
bool ob_paper_run(const ob_paper_plan *p, const char *commit, const char *folder, bool fresh, ob_paper_results *r,
		  ob_error *e);

// Writes report.html and tables.md into an existing folder. The same results give the same files. One thread at a time per
// folder.
bool ob_paper_report(const ob_paper_results *r, const char *dir, ob_error *e);

// Writes claims, means and all runs as one object of JSON.
void ob_paper_write_json(const ob_paper_results *r, const char *version, FILE *f);

// ---- trial

// One experiment: boxes fall in a universe that runs in real time, not faster. The simulators are measured first,
// without a viewer; then a viewer draws, and its frames are counted.

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
