// Faults that are asked for (settings.h): a simulator fails as one might whose code has a bug, at chances that are the same
// in each run of the same workers.
#ifndef OB_SIM_FAULT_H
#define OB_SIM_FAULT_H

#include "sim/state.h"

// A chance to fail. It does not return from some.
void ob_fault_chance(ob_sim *s);

#endif
