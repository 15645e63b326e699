// The spatial index of the universe: a hierarchical hash grid (Ericson 2005, ch. 7.2) in the exchange area.
//
// Each object lies in the one cell of its size class that holds the centre of its bounds; a cell's side is the
// smallest power of two that is not below the bounds' longest side. Whoever asks for the neighbours of a box looks
// through the cells around it at every class in use. One writer (the arranger), then any number of readers.
#ifndef OB_SIM_BROADPHASE_H
#define OB_SIM_BROADPHASE_H

#include <ob/motion.h>

#include "table/table.h"

// Puts the object where its bounds are now (new or moved). Planes go to the list of planes.
void ob_index_put(ob_universe *u, uint32_t id);
void ob_index_remove(ob_universe *u, uint32_t id);
// All other objects whose bounds overlap those of id, in no particular order. Writes up to max ids, returns how many
// there are. tests grows by the boxes that were compared.
uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests);

// What an object knows of its surroundings: the box that it claims, and who else's box overlaps it.

// Bound of what turning adds to the speed of any point of the object (m/s); 0 for spheres, and for what does not turn.
double ob_turning_speed(ob_vec3 w, ob_shape shape, ob_vec3 size);
// Bound of the speed of any point of the object (m/s).
double ob_surface_speed(ob_vec3 v, ob_vec3 w, ob_shape shape, ob_vec3 size);
// How far any point of the object may get in one step from these velocities (m), under what pulls at it.
double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_vec3 v, ob_vec3 w);
// Does the object's claimed box still hold it for its next step? If not, claims a new one, a little larger than needed
// so that it lasts, and asks for the index and the neighbours to be brought up to date. reach: m, for the next step.
void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach);
// Same for a box that holds a flight, and the margin (m) around it.
void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin);
// Same, with the box always made anew.
void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach);

// The object looks around: fills its perceived list. box_tests grows by the boxes that were compared.
void ob_broadphase_query(ob_universe *u, uint32_t id, uint64_t *box_tests);
bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id);

// The pairs of objects whose claimed boxes overlap, sorted by (a, b), each with a record while they touch.

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
