// Free flight: an object that nothing touches is where its closed form says, from the instant at which its flight
// began. Its owner foresees when it may come down on a plane, and nobody visits it before; what else may touch it is the
// arranger's to see (ob_schedule.reach).
//
//   visited             not visited             visited
//   ──┬───────────────┬───────────── … ──────┬──────────┬──
//     │ flight, plan  │  (who looks evaluates) │ bounce │      valid_until = the bounce, or the horizon
//     └─ published ───┴──> valid_until ────────┴─ published
#ifndef OB_SIM_LEAP_H
#define OB_SIM_LEAP_H

#include "sim/worker.h"

// The flight that a lone object is in after the running step's start: the one published, or, where something else pulls
// at it than was published, one that begins now. valid_until: it meets no plane before.
ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id);
// ob_state_now for a motion of object id, at an instant (s), to the last bit, but for the plan of the spin, which is kept.
ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *flight, double time);

// A lone object that touches nothing, or bounces off a plane: moves it through the running step and publishes it, to
// be visited again when it must. false: what happens to it is none of this, and nothing was done.
bool ob_ballistic_advance(ob_sim *s, uint32_t id);

#endif
