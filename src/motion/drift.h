// Drift: free rotation of a rigid body over a short time. Momentum is kept to rounding and energy to the last digits,
// whatever the moments and however often it is repeated; cheaper than to plan the closed form (spin.h) for a single
// use. Pure functions, thread-safe. Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_DRIFT_H
#define OB_MOTION_DRIFT_H

#include <ob/vec.h>

// The turn, in the frame of the body, that it makes in s (of any sign) from the rate w (body frame): the attitude q
// becomes q turn. A moment that is not positive counts as "any": w stays constant.
ob_quat ob_drift_turn(ob_vec3 w, ob_vec3 inertia, double s);

// The same for less, for turns of up to .2 rad: off by a fiftieth of the turn's fifth power at most.
ob_quat ob_drift_short_turn(ob_vec3 w, ob_vec3 inertia, double s);

// Attitude and rate (world frame) after s.
void ob_drift(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out);

// The same for less, for a body whose contacts change its rate by much more: its attitude is off by 1e-11 at most.
void ob_drift_held(ob_quat q, ob_vec3 w, ob_vec3 inertia, double s, ob_quat *q_out, ob_vec3 *w_out);

// Rotation vector (rad, world frame) of the turn from one attitude to another: of small turns, to six digits.
ob_vec3 ob_small_turn(ob_quat from, ob_quat to);

// Bound of the angular speed (rad/s) within s (>= 0) from the rate w (body frame).
double ob_drift_bound(ob_vec3 w, ob_vec3 inertia, double s);

#endif
