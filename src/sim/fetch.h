// What an island needs is on its way from memory while the one before it is solved.
#ifndef OB_SIM_FETCH_H
#define OB_SIM_FETCH_H

#include "sim/worker.h"

// Island i of the universe will be solved soon, by this worker. Of large ones the beginning.
void ob_fetch_island(ob_sim *s, uint32_t i);

#endif
