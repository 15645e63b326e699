// Free flight by ODE's stepper, which computes no impacts ahead: an experiment.
#ifndef OB_STEP_ODE_FLIGHT_H
#define OB_STEP_ODE_FLIGHT_H

#include "step/state.h"

// Does what ob_ballistic_advance does (flight.h), by one step for each object. done: true for all.
void ob_ode_flight_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done);

#endif
