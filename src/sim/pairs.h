// The pairs of objects whose claimed boxes overlap, sorted by (a, b), each with a record while they touch.
#ifndef OB_SIM_PAIRS_H
#define OB_SIM_PAIRS_H

#include "table/table.h"

// Merges what the objects of the rebound list have perceived into the pairs. The arranger alone. steps: that are complete
// as far as motions go (sim/now.h).
void ob_pairs_merge(ob_universe *u, uint64_t steps);
// Drops every pair of an object that goes away.
void ob_pairs_drop(ob_universe *u, uint32_t id);
// Gives its record back, if it has one. The arranger, between steps: what a step has written may be read until its end.
void ob_pair_let_go(ob_universe *u, ob_pair_key *k);
// A pair's state when so many steps were complete; NULL if it was never touched until then. A step's solver reads that,
// and writes the other version, which holds when one more step is complete; so a step can be solved again.
const ob_pair_state *ob_pair_before(const ob_pair_record *r, uint64_t steps);
ob_pair_state *ob_pair_write(ob_pair_record *r, uint64_t steps);

// Lower bound of the distance between two objects (m): of their boxes and bounding spheres, or of a sphere and a plane.
double ob_pairs_apart(const ob_universe *u, uint32_t a, uint32_t b, uint64_t steps);

#endif
