// A second solver, which takes an island through the same step from the same start with another number of substeps. The
// difference of the two solutions shows the error of the coarser one, whatever causes it.
//
//   read island ──> probe: other substeps ──> states at the step's end ───────────────┐
//        └────────> solver of the run ──────> states at the step's end ──> publish    difference
//
// It leaves no trace: it has its own memory, counters and budget, and its contacts and touches go nowhere.
#ifndef OB_STEP_PROBE_H
#define OB_STEP_PROBE_H

#include "step/state.h"

// Creates a probe in *to, for thresholds of a run with so many substeps. Returns false if there is no memory.
bool ob_probe_create(ob_probe **to, ob_sim *s, uint32_t substeps);
void ob_probe_destroy(ob_probe *p);

// Solves the island. Returns false if that would take more work (step/budget.h) than `most`.
bool ob_probe_solve(ob_probe *p, ob_sim *s, const ob_island_input *in, uint32_t substeps, uint64_t most);
// Returns the distance (m) of a surface point of member i between its state `end` and the probe's, at most. speed: m/s,
// the same of the point's velocity.
double ob_probe_distance(const ob_probe *p, uint32_t i, const ob_passport *passport, const ob_state *end,
			 double *speed);

#endif
