// Injected faults (settings.h): a simulator fails as if its code had a bug, at chances that are the same in each run
// with the same workers.
#ifndef OB_STEP_FAULT_H
#define OB_STEP_FAULT_H

#include "step/state.h"

// Draws a chance to fail, and fails if it hits. Some faults do not return.
void ob_fault_chance(ob_sim *s);
// The same for a worker that has had so many chances in its process.
void ob_fault_chance_of(ob_universe *u, uint32_t worker, uint64_t *chances);

#endif
