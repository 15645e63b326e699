// Free flight. An object that touches nothing follows a closed form from the instant at which its flight began. When it
// is solved, its next impact on a plane is computed ahead (conservative advancement), and no step solves it before that;
// what else may touch it, the forecast sees (late_contacts.h), and two that meet are moved together (meeting.h).
//
//   solved              not solved              solved
//   ──┬───────────────┬───────────── … ──────┬──────────┬──
//     │ flight        │ (readers evaluate it)  │ impact │      valid_until = the impact, or the horizon
//     └─ published ───┴──> valid_until ────────┴─ published
#ifndef OB_SIM_FLIGHT_H
#define OB_SIM_FLIGHT_H

#include "sim/state.h"

// The flight of an object without contacts at the start of the running step: the one published or, where its external
// acceleration has changed since, one that begins now. It meets no plane before valid_until.
ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id);
// As ob_state_now at an instant (s), to the last bit, with the worker's cached rotation.
ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *flight, double time);

// Moves an object without contacts through the running step, with its impacts on planes, and publishes its motion. false:
// the contact solver must do it, and nothing was changed.
bool ob_ballistic_advance(ob_sim *s, uint32_t id);

// Publishes the motion m of an object that must be solved in the next step, or rests until something comes near it: its
// fat AABB for that step, from its state at the end of this one, its schedule record, and m, which gets its reach.
void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end);

#endif
