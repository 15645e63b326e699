// What an island or a pair needs is on its way from memory while the one before it is worked on.
#ifndef OB_SIM_PREFETCH_H
#define OB_SIM_PREFETCH_H

#include "sim/state.h"

// Island i of the universe will be solved soon, by this worker. Of large ones the beginning.
void ob_prefetch_island(ob_sim *s, uint32_t i);

// The two of a pair will be looked at soon, from outside.
void ob_prefetch_pair(ob_sim *s, const ob_pair_key *k);

#endif
