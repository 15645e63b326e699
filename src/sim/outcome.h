// What an island's solver has found for each member, until the step stands.
//
//   solved ──stage──> outcome ──(nothing met it that was not foreseen)──commit──> published
//                        ^                    │
//                        └──solved again──────┘  from what was published before the step
//
// A worker that runs many objects stages straight into their slots. One that runs its own object alone writes no other
// slot: it leaves the outcome of the others in ob_step_data.result, from where they adopt it.
#ifndef OB_SIM_OUTCOME_H
#define OB_SIM_OUTCOME_H

#include "sim/worker.h"

// By the island's solver.
void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m);
// As staged, if the object's island was solved in this step and that is not yet committed; else as published.
const ob_motion *ob_result_of(const ob_universe *u, uint32_t id);
// By the arranger: publishes all that was staged in slots; no object is in an island any more.
void ob_results_commit(ob_sim *s);
// By an object with a worker of its own whose island's leader is another: publishes what that has left for it.
void ob_result_copy(ob_sim *s, uint32_t id);

#endif
