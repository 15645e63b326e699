// Bounces off planes at their instants: what happens to a body that flies, between two flights.
#ifndef OB_SIM_BOUNCE_H
#define OB_SIM_BOUNCE_H

#include "sim/worker.h"

// When the flight first meets a plane (s), from an instant on; infinity: not until "until". plane: its id.
double ob_plane_impact_time(ob_sim *s, uint32_t id, const ob_motion *flight, double from, double until, uint32_t *plane);

// Changes velocities as the impact of the point that has met the plane does. false: it does not rebound here.
bool ob_plane_impact(const ob_sim *s, uint32_t id, uint32_t plane, ob_state *state);

#endif
