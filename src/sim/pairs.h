// The pairs of objects whose claimed boxes overlap, sorted by (a, b), each with a record that persists while they do.
#ifndef OB_SIM_PAIRS_H
#define OB_SIM_PAIRS_H

#include "table/table.h"

// Merges what the objects of the rebound list have perceived into the pairs. The arranger alone.
void ob_pairs_merge(ob_universe *u);
// Drops every pair of an object that goes away.
void ob_pairs_drop(ob_universe *u, uint32_t id);
// The newest version of a pair's state that belongs to the past; NULL if it was never touched.
const ob_pair_state *ob_pair_newest(const ob_pair_record *r);
// The version to write in this step: not the newest, so that a step can be done again.
ob_pair_state *ob_pair_writable(ob_pair_record *r);
void ob_pair_written(ob_pair_record *r, uint64_t step);

// Lower bound of the distance between two objects (m): of their boxes and bounding spheres, or of a sphere and a plane.
double ob_pairs_apart(const ob_universe *u, uint32_t a, uint32_t b);

#endif
