// Value and rate of a joint's free axis, from the states of its two objects.
#ifndef OB_MOTION_JOINT_VALUE_H
#define OB_MOTION_JOINT_VALUE_H

#include <ob/joint.h>

// Angle (rad) from x to the first of two axes across that of a hinge; as near to the middle of its limits as it can be.
double ob_joint_turn(const ob_joint_axis *axis, ob_vec3 x, ob_vec3 first, ob_vec3 second);
// Rotation (rad) along its axis, at most half a turn.
ob_vec3 ob_joint_twist(ob_quat q);
// states: of the two objects; of the world, one that does not move. false: this kind has no free axis.
bool ob_joint_value(const ob_joint_passport *j, const ob_state states[2], double *value, double *rate);

#endif
