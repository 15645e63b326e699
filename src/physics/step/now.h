// Motion of an object that holds now, within a step, and the place of the object by it. A motion describes the path from
// an instant on, which may be long ago.
#ifndef OB_STEP_NOW_H
#define OB_STEP_NOW_H

#include <ob/motion.h>

#include "table/table.h"

// Newest motion: as staged, if the object's island was solved in this step and that is not yet committed; else as
// published.
const ob_motion *ob_result_of(const ob_universe *u, uint32_t id);

// steps: number of complete steps; the instant is this number times the step's length.
// State of object id by its motion, published or staged: as ob_snapshot_state computes it, to the last bit.
ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Its centre alone, which costs less.
ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Bound of the length of its path (m), as ob_motion.path.
double ob_path_now(const ob_motion *m, uint64_t steps);

#endif
