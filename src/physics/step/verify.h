// True errors of a sample of island steps (--set verify=on): a probe solves them with many more substeps, and the differences
// go into the counters. The sample follows from the lowest id of the island and the step: any worker takes the same.
#ifndef OB_STEP_VERIFY_H
#define OB_STEP_VERIFY_H

#include "step/state.h"

// Verifies the step of an island that has just been solved, if it belongs to the sample.
void ob_verify(ob_sim *s, const ob_island_input *in);

#endif
