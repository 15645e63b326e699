// True errors of a sample of island steps (--verify): a probe solves them with many more substeps, and the differences
// go into the counters. The sample follows from the lowest id of the island and the step: any worker takes the same.
#ifndef OB_STEP_VERIFY_H
#define OB_STEP_VERIFY_H

#include "step/state.h"

// Solves the island finely if it belongs to the sample. Comes before the island's own solution.
void ob_verify_solve(ob_sim *s, const ob_island_input *in);
// Counts the error of member i, whose step ends in this state; outside of the sample it does nothing.
void ob_verify_compare(ob_sim *s, uint32_t i, const ob_island_object *object, const ob_state *end);

#endif
