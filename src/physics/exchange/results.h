// Results that workers find in a phase. A worker that can write the universe writes them in place, at once. A contained
// simulator (table/outbox.h) cannot: it hands them over as records, which the arranger checks and writes (commit.h).
#ifndef OB_EXCHANGE_RESULTS_H
#define OB_EXCHANGE_RESULTS_H

#include "solver/solver.h"
#include "table/outbox.h"
#include "table/table.h"

// True if all values are numbers of plausible size: below 1e15 m, m/s, rad/s.
bool ob_state_is_sane(const ob_state *s);
// Motion of an object after the step; state, due: as in ob_schedule.
typedef struct ob_found_result {
	uint32_t id, state, due, reserved;
	ob_motion motion;
} ob_found_result;

enum { OB_LATE_CONTACTS_BATCH = 256 }; // pairs that a worker checks at a time

// Called by the worker that found the result; each line names its phase.

void ob_commit_result(ob_universe *u, const ob_found_result *r); // ISLANDS
void ob_commit_bounds(ob_universe *u, uint32_t id, const float box[6]); // ISLANDS; and by the host
void ob_commit_effort(ob_universe *u, uint32_t island, uint32_t share); // ISLANDS; share: each member's
void ob_commit_contact(ob_universe *u, const ob_found_contact *c); // ISLANDS
void ob_commit_joint(ob_universe *u, const ob_found_joint *j); // ISLANDS
// Notes for the object's script that it has begun to touch another, and adds a normal impulse (N s) at this point (m).
// other OB_NO_OBJECT: drops the notes of this step.
void ob_commit_touch(ob_universe *u, uint32_t id, uint32_t other, double impulse, ob_vec3 point); // ISLANDS, BASELINE
// Hands over a script's result. Only for contained simulators: other workers have run the script in place.
void ob_hand_over_script(ob_universe *u, uint32_t cell, const ob_script_turn *turn, const ob_script_cell *c); // SCRIPTS
void ob_commit_check(ob_universe *u, uint32_t check, const ob_pair_key *k); // FORECAST, LATE_CONTACTS
// Commits the number of an object's neighbours, and the changes to its pairs (ob_step_data.neighbour_id).
void ob_commit_neighbours(ob_universe *u, uint32_t id, uint32_t neighbours, const uint32_t *changes,
			  uint32_t count); // BROADPHASE

// True if the island's leader leaves the object's motion in ob_step_data.result, not in its slot: with a worker per
// object.
bool ob_is_left_in_result(const ob_universe *u, uint32_t id);

// ---- touches

// Contacts that begin in a step, noted for the scripts of their bodies: on_contact is called before the next step
// (step/scripts.h). The solver of a body's island notes them (results.h), or the one ODE world.

// True if the script of a member receives its contacts.
bool ob_touches_are_felt(const ob_universe *u, const ob_island *is);
// Forgets the touches noted in an earlier attempt to solve the island.
void ob_touches_begin(ob_universe *u, const ob_island *is);
// Notes that two objects began to touch at a point (m), or adds to their normal impulse (N s).
void ob_touches_note(ob_universe *u, uint32_t a, uint32_t b, double impulse, ob_vec3 point);

#endif
