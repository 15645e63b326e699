// The broad phase: which objects may touch.
//
//   fat AABB changes ──> requery list ──> index ──(query, in parallel)──> neighbours ──(merge)──> pairs
//
// Each object has a fat AABB, which holds it for some steps. When it no longer does, the object gets a new one and a
// place on the list of objects to requery. The scheduling worker moves those in the spatial index, workers query it for
// their neighbours, and the scheduling worker merges the answers into the pairs (sim/pairs.h).
#ifndef OB_SIM_BROADPHASE_H
#define OB_SIM_BROADPHASE_H

#include <ob/motion.h>

#include "table/table.h"

// ---- fat AABBs

// Bound of what turning adds to the speed of an object's surface (m/s) within s from the rate w (rad/s, frame of the
// object); 0 for spheres, without rotation, and where a round body spins about its axis.
double ob_turning_speed(ob_shape shape, ob_vec3 size, ob_vec3 inertia, ob_vec3 w, double s);
// How far any point of the object may get in one step from this attitude and these velocities (m), under its external
// acceleration.
double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_quat q, ob_vec3 v, ob_vec3 w);
// The smallest box that holds an object in this pose.
void ob_tight_aabb(const ob_universe *u, const ob_passport *p, ob_pose pose, double bounds[6]);
// If the object's fat AABB does not hold it for its next step, or is much too large, makes a new one and appends the
// object to the requery list. now: its state at the end of the step; reach: m, in the next step; path: m, of any of its
// points in the step that was solved, which a new one holds, too.
void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach, double path);
// m: what a fat AABB leaves on all sides of an object that rests or flies on as it does.
double ob_fat_aabb_margin(const ob_run_settings *run, ob_shape shape, ob_vec3 size);
// As ob_fat_aabb_update, for a box that holds a whole flight, and the margin (m) around it.
void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin);
// The same box and margin in any case.
void ob_fat_aabb_set(ob_universe *u, uint32_t id, const double *box, double margin);
// As ob_fat_aabb_update, with a new box in any case.
void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach);

// ---- spatial index: a hierarchical hash grid (Ericson, Real-Time Collision Detection, 2005, ch. 7.2)
//
// Each object lies in the one cell of its size class that holds the centre of its box; a cell's side is the smallest
// power of two that is not below the box's longest side. A query searches the cells around its box at every class in
// use. One writer (the scheduling worker), then any number of readers.

// Puts the object where its fat AABB is now (new or moved). Planes go to the list of planes.
void ob_index_put(ob_universe *u, uint32_t id);
void ob_index_remove(ob_universe *u, uint32_t id);
// Where a search for the object finds it. NOWHERE: it is not in the index. BROKEN: it is, and no search of the cell
// that holds its box's centre finds it. The scheduling worker, or the host at a pause.
typedef enum ob_index_place { OB_INDEX_NOWHERE, OB_INDEX_CELL, OB_INDEX_PLANE, OB_INDEX_BROKEN } ob_index_place;
ob_index_place ob_index_find(const ob_universe *u, uint32_t id);
// Where so many are put, at place i: what of those that follow lies anywhere is asked for.
void ob_index_prefetch(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end);
// All other objects whose boxes overlap that of id, in no particular order. Writes up to max ids, returns how many
// there are. tests grows by the boxes that were compared.
uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests);

// Whether it has a new fat AABB, and its neighbours are not yet known.
bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id);
// Removes an object that goes away from the index and from the requery list: else its query would be made, and would
// find pairs of an absent object. The host, at a pause.
void ob_broadphase_remove(ob_universe *u, uint32_t id);

#endif
