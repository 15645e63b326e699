// Free flight: an object that nothing touches is where its closed form says, from the instant at which its flight
// began; no substeps.
#ifndef OB_SIM_LEAP_H
#define OB_SIM_LEAP_H

#include "sim/worker.h"

// The state at the end of the running step of an object that nothing touches in it. *flight is what its motion must
// say of that (ob_motion.flight). Notes where the flight began, if it begins now; may be called again for the same step.
ob_state ob_leap_end(ob_sim *s, uint32_t id, uint32_t *flight);

// A lone object that touches nothing: moves it and publishes it.
void ob_leap(ob_sim *s, uint32_t id);

#endif
