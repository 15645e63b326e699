// Where the two bodies of a touch meet, now or within the coming substep.
#ifndef OB_SIM_LOOK_H
#define OB_SIM_LOOK_H

#include "contact/manifold.h"
#include "sim/state.h"

// Fills m with the pair's points, their gaps as of now. Fast pairs are followed through the substep: *when is the time
// into it at which the points were found (s; 0 otherwise), and their arms run from where the centres are then.
// tolerance: m, gaps up to it are always found. Both bodies' poses must be up to date (ob_body_update_pose).
void ob_narrowphase_find(ob_sim *s, const ob_contact *t, double tolerance, ob_manifold *m, double *when);

// Finds the points of any two shapes, as the run wants them found.
ob_manifold_finder ob_narrowphase_finder(ob_sim *s);

// When do the two meet, if they go on as they do (s from now)? Infinity: not before "horizon".
double ob_narrowphase_time_of_impact(ob_sim *s, const ob_contact *t, double horizon);

#endif
