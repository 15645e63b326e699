// Broad phase: finds pairs of objects that may touch.
//
//   fat AABB changes ──> requery list ──> index ──(query, in parallel)──> neighbours ──(merge)──> pairs
//
// Each object has a fat AABB, which holds it for some steps. An object that leaves its box gets a new one and a place
// on the requery list. The scheduling worker moves these objects in the spatial index, and all workers query it for
// their neighbours. Then the scheduling worker merges the answers into the pairs (step/pairs.h).
#ifndef OB_STEP_BROADPHASE_H
#define OB_STEP_BROADPHASE_H

#include <ob/motion.h>

#include "table/table.h"

// ---- fat AABBs

// Bounds the distance (m) that any point of the object moves in one step from this attitude and these velocities, under
// its external acceleration.
double ob_step_reach(const ob_run_settings *run, const ob_passport *p, ob_quat q, ob_vec3 v, ob_vec3 w);
// Computes the smallest box that holds an object in this pose.
void ob_tight_aabb(const ob_universe *u, const ob_passport *p, ob_pose pose, double bounds[6]);
// Makes a new fat AABB if the present one does not hold the object for its next step, or is much too large; then
// appends the object to the requery list. now: state at the end of the step; reach: bound of motion in the next step
// (m). path: distance (m) that any of its points moved in the solved step; a new box covers it, too.
void ob_fat_aabb_update(ob_universe *u, uint32_t id, const ob_state *now, double reach, double path);
// Returns the margin (m) of a fat AABB on all sides, for an object at rest or in unchanged flight.
double ob_fat_aabb_margin(const ob_run_settings *run, ob_shape shape, ob_vec3 size);
// Does the same as ob_fat_aabb_update for a whole flight: box holds it, margin (m) surrounds it.
void ob_fat_aabb_sweep(ob_universe *u, uint32_t id, const double *box, double margin);
// Sets box and margin (m) unconditionally.
void ob_fat_aabb_set(ob_universe *u, uint32_t id, const double *box, double margin);
// Makes a new box as ob_fat_aabb_update does, but unconditionally.
void ob_fat_aabb_renew(ob_universe *u, uint32_t id, const ob_state *now, double reach);

// ---- spatial index: a hierarchical hash grid (Ericson, Real-Time Collision Detection, 2005, ch. 7.2)
//
// Each object lies in one cell of its size class: the one that holds the centre of its box. A cell's side is the
// smallest power of two that is not below the box's longest side. A query searches the cells around its box in every
// class in use. One writer (the scheduling worker), then any number of readers.

// Enters the object, new or moved, where its fat AABB is now. Planes go to the list of planes.
void ob_index_put(ob_universe *u, uint32_t id);
void ob_index_remove(ob_universe *u, uint32_t id);
// Returns where the index holds the object. OB_INDEX_NOWHERE: not in the index. OB_INDEX_BROKEN: in it, but a search of
// the cell around its box's centre does not find it. Called by the scheduling worker, or by the host at a pause.
typedef enum ob_index_place { OB_INDEX_NOWHERE, OB_INDEX_CELL, OB_INDEX_PLANE, OB_INDEX_BROKEN } ob_index_place;
ob_index_place ob_index_find(const ob_universe *u, uint32_t id);
// Prefetches data of the objects that follow place i of a list that is put into the index.
void ob_index_prefetch(const ob_universe *u, const uint32_t *ids, uint32_t i, uint32_t end);
// Finds all other objects whose boxes overlap that of id, in no particular order. Writes up to max ids; returns the
// number found, which may exceed max. Adds the number of compared boxes to tests.
uint32_t ob_index_query(const ob_universe *u, uint32_t id, uint32_t *out, uint32_t max, uint64_t *tests);

// True if the object has a new fat AABB whose neighbours are not yet known.
bool ob_broadphase_query_pending(const ob_universe *u, uint32_t id);
// Removes a leaving object from the index and the requery list. Otherwise its query would find pairs of an absent
// object. Called by the host at a pause.
void ob_broadphase_remove(ob_universe *u, uint32_t id);

#endif
