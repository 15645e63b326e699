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
// Publishes all that was staged in slots for islands first .. end-1, by one worker or by several; their objects are in no
// island any more.
void ob_results_commit(ob_sim *s, uint32_t first, uint32_t end);
// By the worker of an object that another one has solved: publishes what that has left for it.
void ob_result_copy(ob_sim *s, uint32_t id);

// Gravity and the constant force of the passport (m/s^2); 0 for static objects.
static inline ob_vec3 ob_external_acceleration(const ob_run_settings *run, const ob_passport *p)
{
	return p->mass > 0 ? ob_madd(run->gravity, 1 / p->mass, p->force) : ob_v3(0, 0, 0);
}

#endif
