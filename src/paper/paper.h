// The paper's experiment (Elfizar et al., "Implementation of Enhanced Axis Aligned Bounding Box for Object Collision
// Detection in Distributed Virtual Environment"), run again: what it measured, and what it left open.
#ifndef OB_PAPER_PAPER_H
#define OB_PAPER_PAPER_H

#include <ob/error.h>

#include "paper/sample.h"

typedef struct ob_paper_plan {
	uint32_t objects, experiments; // boxes in each experiment; how many of them, 64 at most
	double alone_s, watched_s; // as in ob_paper_trial
	size_t sizes; // of the series with more and more objects
	const uint32_t *size;
	uint32_t repeats; // of each size
} ob_paper_plan;

ob_paper_plan ob_paper_plan_full(void); // the paper's 15 experiments: about ten minutes
ob_paper_plan ob_paper_plan_quick(void); // to see that it works: no figure of it means much

// Told before each run; NULL = nobody asks
typedef void ob_paper_tick(size_t done, size_t all, double left_s, const char *what);

// Runs all, in an order that puts no scenario always first. A run that fails is a sample that says so. false and e:
// interrupted, no memory, or nothing could be run at all. Starts processes; from a process without other threads.
bool ob_paper_run(const ob_paper_plan *p, ob_paper_tick *tick, ob_paper_results *r, ob_error *e);

#endif
