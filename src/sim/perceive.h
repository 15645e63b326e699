// What an object knows of its surroundings: the box that it claims, and who else's box overlaps it.
#ifndef OB_SIM_PERCEIVE_H
#define OB_SIM_PERCEIVE_H

#include <ob/motion.h>

#include "table/table.h"

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

#endif
