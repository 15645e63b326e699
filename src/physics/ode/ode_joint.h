// Joints of ODE's world, by ODE's own kinds. What acts along an axis is one of its motors: a spring with its damper is a motor
// with the velocity and the softness that give the implicit rule of first order, as ODE's manual has it.
//
// Thread-safety: as the world's.
#ifndef OB_ODE_JOINT_H
#define OB_ODE_JOINT_H

#include <ob/joint.h>
#include <ode/ode.h>

// An end: its body, or NULL and where it stands.
typedef struct ob_ode_end {
	dBodyID body;
	ob_pose placed;
} ob_ode_end;

typedef struct ob_ode_joint ob_ode_joint;

// p->kind is not OB_JOINT_APART; ob_ode_has_joint. NULL: no memory.
ob_ode_joint *ob_ode_joint_create(dWorldID world, const ob_joint_passport *p, const ob_ode_end end[2]);
void ob_ode_joint_destroy(ob_ode_joint *j); // NULL is allowed
// Sets what acts along its axis, before a step of h (s).
void ob_ode_joint_drive(ob_ode_joint *j, const ob_joint_axis *axis, double h);
// Action in the last step on its first object (ob_joint_load).
void ob_ode_joint_load(const ob_ode_joint *j, ob_joint_load *out);

#endif
