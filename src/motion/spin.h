// Torque-free rotation of a rigid body, evaluated at any time: over a short one by Magnus's expansion (magnus.h), over
// a long one in closed form, whose constants are computed when they are first asked for. What comes out follows from
// what the rotation was planned with and from the time alone. Pure functions but for that, so a plan is of one thread.
// Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_SPIN_H
#define OB_MOTION_SPIN_H

#include <stdbool.h>

#include <ob/vec.h>

#include "motion/jacobi.h"

typedef enum ob_spin_kind {
	OB_SPIN_TURNS, // symmetric tops, spin about a principal axis, rest: two turns at constant rates
	OB_SPIN_THETA, // three different moments
} ob_spin_kind;

typedef struct ob_spin {
	ob_spin_kind kind;
	bool planned; // the constants of long turns are known
	ob_quat q; // attitude at s = 0, body to world
	ob_vec3 w, rate_0; // rad/s, at s = 0: world frame, body frame
	ob_vec3 inertia;
	double fastest; // rad/s, at any time, or more
	double last; // s, that was asked for last, and the answer
	ob_quat last_q;
	ob_vec3 last_w;

	// OB_SPIN_TURNS: about a fixed axis of the world, after a turn about a fixed axis of the body
	ob_vec3 world; // rad/s, world frame
	ob_vec3 body; // rad/s, body frame

	// OB_SPIN_THETA, in the frame of the sorted axes: component i is sign[i] times component axis[i] of the body
	int axis[3];
	double sign[3];
	ob_vec3 rate; // momentum / moment along each axis of the body for a unit direction, rad/s
	ob_vec3 amplitude; // of cn, sn, dn in the direction of the momentum
	double m, mc, root_kc; // parameter of the elliptic functions k^2, 1 - k^2, and sqrt(k')
	double phase, speed; // rad, rad/s: argument of the theta functions
	double precession; // rad/s, mean rate of turn about the momentum
	double side; // +1 or -1: sign of the imaginary shift
	double cos0, sin0; // direction that the azimuth about the momentum has at s = 0
	ob_quat lift0; // turn of the momentum's direction at s = 0 to the third axis
	ob_theta theta;
} ob_spin;

// q is a unit quaternion, w in the world frame. A moment that is not positive counts as "any": w stays constant.
void ob_spin_plan(ob_spin *spin, ob_quat q, ob_vec3 w, ob_vec3 inertia);

// Bound of the angular speed (rad/s) of a free body that turns with w at q, at any time.
double ob_spin_bound(ob_quat q, ob_vec3 w, ob_vec3 inertia);

// How much the path of a point may bend that turns freely about the centre, per metre from it, at angular speeds of up
// to w (rad/s).
typedef struct ob_bending {
	ob_vec3 coupling; // c of Euler's equations b_i' = c_i b_j b_k, for the rate b in the frame of the body
	double most, jerk; // 1/s^2, 1/s^3: of the second and third derivative of the arm
} ob_bending;

ob_bending ob_bending_of(ob_vec3 inertia, double w);

// |q|^2 - 1 to the last digit, of a q that is nearly a unit quaternion.
double ob_quat_excess(ob_quat q);

// Attitude and rate (world frame) at s, which may be negative.
void ob_spin_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out);

#endif
