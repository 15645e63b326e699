// Where an object is now. What is published says how it moves from an instant on, which may be long ago: who wants the
// present evaluates it. "steps" counts the complete ones, so the instant is their number times the step's length.
#ifndef OB_SIM_NOW_H
#define OB_SIM_NOW_H

#include <ob/motion.h>

#include "table/table.h"

// A motion of object id, published or staged: as ob_snapshot_state has it, to the last bit.
ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Its centre alone, which costs less.
ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// m, as ob_motion.path
double ob_path_now(const ob_motion *m, uint64_t steps);

#endif
