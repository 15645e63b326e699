// Free running: simulators that wait for nobody. docs/design/free.md has a drawing. Simulators have times of their own
// (simulator.h); the host shows everybody else the common time, which all have passed.
#ifndef OB_FREE_FREE_H
#define OB_FREE_FREE_H

#include "table/free.h"

// Runs a worker: the simulators of its objects, each at its own time, until the run stops. false and e: no memory.
bool ob_free_work(ob_universe *u, uint32_t worker, ob_error *e);

// Depth of the rings of versions that a run needs. step: s; capacity: objects.
uint32_t ob_free_plan_depth(const ob_free_settings *f, double step, uint32_t capacity);
// Number of steps by which simulators may be ahead of the common time.
uint64_t ob_free_window(const ob_universe *u);

// Host, while all simulators wait or none runs: enters objects that were placed, changed or removed.
void ob_free_enter_objects(ob_universe *u);
// Host: completes the steps that all simulators have passed, up to `step`: shows their states at that time in the slots.
// Returns the number of complete steps.
uint64_t ob_free_complete(ob_universe *u, uint64_t step);

// A worker, as far as the common time is concerned.
typedef enum ob_free_part {
	OB_FREE_DONE, // all of its simulators have passed the next boundary, or are not due by the clock or the host
	OB_FREE_WAITS, // for a neighbour that is behind
	OB_FREE_HOLDS, // it has to go on, and all others may wait for it: the worker of the earliest simulator does, for one
} ob_free_part;
// Host: finds the part of each worker: part[workers].
void ob_free_find_parts(const ob_universe *u, unsigned char *part);

// Sums over all objects for the report.
typedef struct ob_free_sums {
	ob_free_counts counts;
	uint32_t objects;
	double least_time, most_time; // s, own times now
} ob_free_sums;
void ob_free_sum(const ob_universe *u, ob_free_sums *out);

#endif
