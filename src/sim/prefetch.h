// Prefetches what an island or a pair needs from memory while the one before it is worked on.
#ifndef OB_SIM_PREFETCH_H
#define OB_SIM_PREFETCH_H

#include "sim/state.h"

// Of island i, which this worker solves soon, where its motions and passports are found; then, when it is next, these.
// Of a large one the beginning.
void ob_prefetch_members(const ob_universe *u, uint32_t i);
void ob_prefetch_island(ob_sim *s, uint32_t i);
// Of an object whose neighbours are looked for soon: its box, and where its passport is found.
void ob_prefetch_query(const ob_universe *u, uint32_t id);

// Of a pair that is checked soon: the schedule records, and where its motions and passports are found; then these.
void ob_prefetch_schedule(const ob_universe *u, const ob_pair_key *k);
void ob_prefetch_pair(ob_sim *s, const ob_pair_key *k);

// Where members of the islands are gone through, at place i of member[]: the first pairs of those that follow.
void ob_prefetch_pairs_of(const ob_universe *u, uint32_t i);
// The same where lists of pairs are gone through, at place i of so many ids.
void ob_prefetch_lists(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end);
// In a list of pairs (sim/pairs.h), the one that follows.
void ob_prefetch_link(const ob_universe *u, uint32_t link);

#endif
