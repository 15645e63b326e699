// Free rotation of a rigid body over a turn of up to .03 rad, by Magnus's expansion of its rotation vector. Pure
// functions, thread-safe. Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_MAGNUS_H
#define OB_MOTION_MAGNUS_H

#include <ob/vec.h>

#define OB_MAGNUS_LONGEST .03 // rad

// Turn in time s (of any sign) from the rate w, in the body frame: the attitude q becomes q turn. Accurate to rounding;
// all moments are positive.
ob_quat ob_magnus_turn(ob_vec3 w, ob_vec3 inertia, double s);

// Cheaper version: accurate to the fifth power of the turn, and below 1e-11 to .03 rad.
ob_quat ob_magnus_turn_of_order_four(ob_vec3 w, ob_vec3 inertia, double s);
ob_quat ob_magnus_turn_of_order_six(ob_vec3 w, ob_vec3 inertia, double s);

// Turn by a rotation vector (rad).
ob_quat ob_magnus_small_turn(ob_vec3 turn);

#endif
