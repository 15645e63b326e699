// Motions within a step: those that are published, those that a solver has staged, and where an object is now.
//
//   solved ──stage──> staged ──(no late contact)──commit──> published
//                       ^            │
//                       └─ solved again, from what was published before the step
//
// A worker that runs many objects stages straight into their slots. One that runs its own object alone writes no other
// slot: it leaves the motions of the others in ob_step_data.result, from where their workers copy them. Where simulators are
// contained, the arranger stages and commits for all (commit.h).
#ifndef OB_SIM_PUBLISH_H
#define OB_SIM_PUBLISH_H

#include <ob/motion.h>

#include "sim/state.h"
#include "table/table.h"

// Of numbers, and none so large that it can be meant: below 1e15 m, m/s, rad/s.
bool ob_state_is_sane(const ob_state *s);
// By the island's solver: stages the motion m and writes the object's schedule record. state: OB_SCHEDULE_*; due: the
// step (from 0) that must visit the object, if nothing comes near before. Of a motion that makes no sense it fails the step.
void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due);
// As staged, if the object's island was solved in this step and that is not yet committed; else as published.
const ob_motion *ob_result_of(const ob_universe *u, uint32_t id);
// Publishes all that was staged in slots for islands first .. end-1, by one worker or by several; their objects are in no
// island any more.
void ob_results_commit(ob_sim *s, uint32_t first, uint32_t end);
// By the worker of an object that another one has solved: publishes what that has left for it.
void ob_result_copy(ob_sim *s, uint32_t id);

// Where an object is now: a motion says how it moves from an instant on, which may be long ago. steps: that are complete,
// so the instant is their number times the step's length.
// A motion of object id, published or staged: as ob_snapshot_state has it, to the last bit.
ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Its centre alone, which costs less.
ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Bound of the way that it has made (m), as ob_motion.path.
double ob_path_now(const ob_motion *m, uint64_t steps);

// Gravity and the constant force of the passport (m/s^2); 0 for static objects.
static inline ob_vec3 ob_external_acceleration(const ob_run_settings *run, const ob_passport *p)
{
	return p->mass > 0 ? ob_madd(run->gravity, 1 / p->mass, p->force) : ob_v3(0, 0, 0);
}

#endif
