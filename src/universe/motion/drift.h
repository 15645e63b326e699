// Drift: free rotation of a rigid body over a short time. It preserves momentum to rounding and energy to the last
// digits, for any moments and any number of repetitions. For a single use, it is cheaper than planning the closed form
// (spin.h). Pure functions, thread-safe. Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_DRIFT_H
#define OB_MOTION_DRIFT_H

#include <ob/vec.h>

// Turn in time s (of any sign) from the rate w, in the body frame: the attitude q becomes q turn. A moment that is not
// positive counts as "any": w stays constant.
ob_quat ob_drift_turn(ob_vec3 w, ob_vec3 inertia, double s);

// Cheaper version for turns of up to .2 rad: its error is at most a fiftieth of the turn's fifth power.
ob_quat ob_drift_short_turn(ob_vec3 w, ob_vec3 inertia, double s);

// Attitude and rate (world frame) after s.
void ob_drift(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out);

// Cheaper version for a body whose contacts change its rate by much more: the attitude error is at most 1e-11.
void ob_drift_held(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out);

// Rotation vector (rad, world frame) of the turn from one attitude to another, to six digits for small turns.
ob_vec3 ob_small_turn(ob_quat from, ob_quat to);

// Bound on the angular speed (rad/s) within s (>= 0) from the rate w (body frame).
double ob_drift_bound(ob_vec3 w, ob_vec3 inertia, double s);

#endif
