// Free rotation of a rigid body over a turn of up to .03 rad, by Magnus's expansion of its rotation vector. Pure
// functions, thread-safe. Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_MAGNUS_H
#define OB_MOTION_MAGNUS_H

#include <ob/vec.h>

#define OB_MAGNUS_LONGEST .03 // rad

// The turn, in the frame of the body, that it makes in s (of any sign) from the rate w (body frame): the attitude q
// becomes q turn. To rounding; all moments are positive.
ob_quat ob_magnus_turn(ob_vec3 w, ob_vec3 inertia, double s);

// The same for less: to the fifth power of the turn, and below 1e-11 to .03 rad.
ob_quat ob_magnus_turn_of_order_four(ob_vec3 w, ob_vec3 inertia, double s);
ob_quat ob_magnus_turn_of_order_six(ob_vec3 w, ob_vec3 inertia, double s);

// The turn by a rotation vector (rad).
ob_quat ob_magnus_small_turn(ob_vec3 turn);

#endif
