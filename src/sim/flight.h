// Free flight: an object that nothing touches is where its closed form says, from the instant at which its flight
// began. Its owner foresees when it may come down on a plane, and nobody visits it before; what else may touch it is the
// arranger's to see (ob_schedule.reach).
//
//   visited             not visited             visited
//   ──┬───────────────┬───────────── … ──────┬──────────┬──
//     │ flight, plan  │  (who looks evaluates) │ bounce │      valid_until = the bounce, or the horizon
//     └─ published ───┴──> valid_until ────────┴─ published
#ifndef OB_SIM_FLIGHT_H
#define OB_SIM_FLIGHT_H

#include "sim/state.h"

// The flight that a lone object is in after the running step's start: the one published, or, where something else pulls
// at it than was published, one that begins now. valid_until: it meets no plane before.
ob_motion ob_ballistic_flight(const ob_sim *s, uint32_t id);
// ob_state_now for a motion of object id, at an instant (s), to the last bit, but for the plan of the spin, which is kept.
ob_state ob_ballistic_state(ob_sim *s, uint32_t id, const ob_motion *flight, double time);

// A lone object that touches nothing, or bounces off a plane: moves it through the running step and publishes it, to
// be visited again when it must. false: what happens to it is none of this, and nothing was done.
bool ob_ballistic_advance(ob_sim *s, uint32_t id);

// Publishes the motion m of an object that must be visited in the next step, or rests until something comes near it:
// its fat AABB for that step, from its state at the end of this one, its schedule record, and m, which gets its reach.
void ob_body_publish(ob_sim *s, uint32_t id, ob_motion *m, const ob_state *end);

// Bounces off planes at their instants: what happens to a body that flies, between two flights.

// When the flight first meets a plane (s), from an instant on; infinity: not until "until". plane: its id.
double ob_plane_impact_time(ob_sim *s, uint32_t id, const ob_motion *flight, double from, double until, uint32_t *plane);

// Changes velocities as the impact of the point that has met the plane does. false: it does not rebound here.
bool ob_plane_impact(const ob_sim *s, uint32_t id, uint32_t plane, ob_state *state);

#endif
