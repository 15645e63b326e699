// Motions within a step: published ones, those staged by a solver, and the present state of an object.
//
//   solved ──stage──> staged ──(no late contact)──commit──> published
//                       ^            │
//                       └─ solved again, from what was published before the step
//
// A worker that runs many objects stages straight into their slots. One that runs its own object alone writes no other
// slot: it leaves the motions of the others in ob_step_data.result, from where their workers copy them. For contained
// simulators the arranger stages and commits (commit.h).
#ifndef OB_STEP_PUBLISH_H
#define OB_STEP_PUBLISH_H

#include <ob/motion.h>

#include "step/state.h"
#include "table/table.h"

// Stages the motion m and writes the object's schedule record; the island's solver calls it. state: OB_SCHEDULE_*; due:
// the step (from 0) that must solve the object, if nothing comes near before. An insane motion fails the step.
void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due);
// Publishes the motions staged in slots for islands first .. end-1, by one worker or by several; then their objects are
// in no island.
void ob_results_commit(ob_sim *s, uint32_t first, uint32_t end);
// Publishes the motion that another worker has solved for this worker's object.
void ob_result_copy(ob_sim *s, uint32_t id);

// ---- now

// Motion of an object that holds now, within a step, and the place of the object by it. A motion describes the path from
// an instant on, which may be long ago.

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
