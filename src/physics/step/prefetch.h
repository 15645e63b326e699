// Prefetches the memory of an island or a pair while the one before it is worked on.
#ifndef OB_STEP_PREFETCH_H
#define OB_STEP_PREFETCH_H

#include "step/state.h"

// Prefetches for island i: first, when this worker solves it soon, the places of its motions and passports; then, when
// it is next, these. For a large island the beginning.
void ob_prefetch_members(const ob_universe *u, uint32_t i);
void ob_prefetch_island(ob_sim *s, uint32_t i);
// Prefetches the box of an object to be queried soon, and the place of its passport.
void ob_prefetch_query(const ob_universe *u, uint32_t id);

// Prefetches for a pair to be checked soon the schedule records, and the places of motions and passports; then these.
void ob_prefetch_schedule(const ob_universe *u, const ob_pair_key *k);
void ob_prefetch_pair(ob_sim *s, const ob_pair_key *k);

// Prefetches pairs that follow place i of check[], up to `end`, and what their bodies are due for.
void ob_prefetch_checks(const ob_step_data *data, uint32_t i, uint32_t end);

// Prefetches the first pairs of the members that follow place i of member[], while a caller walks the islands' members.
void ob_prefetch_pairs_of(const ob_universe *u, uint32_t i);
// The same for the lists of pairs of ids[i] and later, up to `end`.
void ob_prefetch_lists(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end);
// Prefetches the next link in a list of pairs (step/pairs.h).
void ob_prefetch_link(const ob_universe *u, uint32_t link);

#endif
