// The paper's experiment (Elfizar et al., "Implementation of Enhanced Axis Aligned Bounding Box for Object Collision
// Detection in Distributed Virtual Environment"), run again: what it measured, and what it left open.
#ifndef OB_PAPER_PAPER_H
#define OB_PAPER_PAPER_H

#include "experiment/experiment.h"
#include "paper/results.h"

typedef struct ob_paper_plan {
	uint32_t objects, experiments; // boxes in each experiment; how many of them, each with other boxes
	double alone_s, watched_s; // as in ob_paper_trial
	size_t sizes; // of the series with more and more objects
	const uint32_t *size;
	uint32_t repeats; // of each size
} ob_paper_plan;

ob_paper_plan ob_paper_plan_full(void); // the paper's 15 experiments: about ten minutes
ob_paper_plan ob_paper_plan_quick(void); // to see that it works: no figure of it means much

ob_experiment ob_paper_experiment(const char *commit);
// The trials, in an order that puts no scenario always first. The plan must outlive them. false and e: no memory.
bool ob_paper_schedule(const ob_paper_plan *p, ob_trials *s, ob_error *e);

// Runs what the folder's results.csv does not have yet; fresh: all. false and e: interrupted, no memory, or nothing
// could be run at all. On several ranks: as ob_experiment_run. Starts processes; from a process without other threads.
// The caller frees r->records.
bool ob_paper_run(const ob_paper_plan *p, const char *commit, const char *folder, bool fresh, ob_paper_results *r,
		  ob_error *e);

#endif
