// What an island's solver has found for each member, until the step stands.
//
//   solved ──stage──> outcome ──(nothing met it that was not foreseen)──commit──> published
//                        ^                    │
//                        └──solved again──────┘  from what was published before the step
//
// A worker that runs many objects stages straight into their slots. One that runs its own object alone writes no other
// slot: it leaves the outcome of the others in ob_step_data.result, from where they adopt it.
#ifndef OB_SIM_PUBLISH_H
#define OB_SIM_PUBLISH_H

#include <ob/motion.h>

#include "sim/state.h"
#include "table/table.h"

// By the island's solver: stages the motion m and writes the object's schedule record. state: OB_SCHEDULE_*; due: the
// step (from 0) that must visit the object, if nothing comes near before.
void ob_result_stage(ob_sim *s, uint32_t id, const ob_motion *m, uint32_t state, uint32_t due);
// As staged, if the object's island was solved in this step and that is not yet committed; else as published.
const ob_motion *ob_result_of(const ob_universe *u, uint32_t id);
// By the arranger: publishes all that was staged in slots; no object is in an island any more.
void ob_results_commit(ob_sim *s);
// By an object with a worker of its own whose island's leader is another: publishes what that has left for it.
void ob_result_copy(ob_sim *s, uint32_t id);

// Where an object is now. What is published says how it moves from an instant on, which may be long ago: who wants the
// present evaluates it. "steps" counts the complete ones, so the instant is their number times the step's length.

// A motion of object id, published or staged: as ob_snapshot_state has it, to the last bit.
ob_state ob_state_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// Its centre alone, which costs less.
ob_vec3 ob_centre_now(const ob_universe *u, uint32_t id, const ob_motion *m, uint64_t steps);
// m, as ob_motion.path
double ob_path_now(const ob_motion *m, uint64_t steps);

// What accelerates an object that touches nothing. Pure functions.

// Gravity and the constant force of its passport, m/s^2; nothing pulls at what never moves.
static inline ob_vec3 ob_external_acceleration(const ob_run_settings *run, const ob_passport *p)
{
	return p->mass > 0 ? ob_madd(run->gravity, 1 / p->mass, p->force) : ob_v3(0, 0, 0);
}

#endif
