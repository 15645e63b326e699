// Torque-free rotation of a rigid body, evaluated at any time. Short turns use Magnus's expansion (magnus.h). Long
// turns use a closed form, whose constants are computed on first use. Results depend on the plan's input and the time
// alone. Pure functions except for this cache, so a plan belongs to one thread. Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_SPIN_H
#define OB_MOTION_SPIN_H

#include <stdbool.h>

#include <ob/vec.h>

typedef enum ob_spin_kind {
	OB_SPIN_TURNS, // symmetric tops, spin about a principal axis, rest: two turns at constant rates
	OB_SPIN_THETA, // three different moments
} ob_spin_kind;

// Constants of OB_SPIN_THETA, in the frame of the sorted axes unless stated otherwise: consecutive numbers; those of
// four rotations are transposed into lanes.
enum {
	OB_THETA_START = 0, // attitude at s = 0
	OB_THETA_RATE = 4, // momentum / moment along each axis of the body for a unit direction, rad/s
	OB_THETA_AMPLITUDE = 7, // amplitudes of cn, sn, dn in the direction of the momentum
	OB_THETA_M = 10, // parameter of the elliptic functions k^2, 1 - k^2, and sqrt(k')
	OB_THETA_MC,
	OB_THETA_ROOT_KC,
	OB_THETA_PHASE, // rad, rad/s: argument of the theta functions
	OB_THETA_SPEED,
	OB_THETA_PRECESSION, // rad/s, mean rate of turn about the momentum
	OB_THETA_SIDE, // +1 or -1: sign of the imaginary shift
	OB_THETA_COS0, // direction of the azimuth about the momentum at s = 0
	OB_THETA_SIN0,
	OB_THETA_LIFT, // turn of the momentum's direction at s = 0 to the third axis
	// the body's axes in terms of the sorted ones, a matrix by rows: 0, 1 and -1
	OB_THETA_FRAME = OB_THETA_LIFT + 4,
	OB_THETA_CONSTANTS = OB_THETA_FRAME + 9,
};

enum { OB_THETA_TERMS = 20 }; // enough for a complementary modulus down to 1e-16, where the nome is .88

// Series of theta_1 and theta_2 at v and of theta_1 at v + i alpha, without their common factor 2 q^(1/4) (and another
// e^alpha / 2 for the complex one): only ratios or directions are used.
typedef struct ob_theta_series {
	int terms;
	double plain[OB_THETA_TERMS]; // q^(n (n + 1))
	double even[OB_THETA_TERMS]; // q^(n (n + 1)) 2 cosh((2 n + 1) alpha) e^-alpha
	double odd[OB_THETA_TERMS]; // q^(n (n + 1)) 2 sinh((2 n + 1) alpha) e^-alpha
} ob_theta_series;

typedef struct ob_spin {
	ob_spin_kind kind;
	bool planned; // the constants of long turns are known
	ob_quat q; // attitude at s = 0, body to world
	ob_vec3 w, rate_0; // rad/s, at s = 0: world frame, body frame
	ob_vec3 inertia;
	double fastest; // rad/s, upper bound at any time
	double last; // s, last instant evaluated, and its result
	ob_quat last_q;
	ob_vec3 last_w;

	// OB_SPIN_TURNS: about a fixed axis of the world, after a turn about a fixed axis of the body
	ob_vec3 world; // rad/s, world frame
	ob_vec3 body; // rad/s, body frame

	// OB_SPIN_THETA
	double theta[OB_THETA_CONSTANTS];
	ob_theta_series series;
} ob_spin;

// Plans a rotation. q is a unit quaternion, w in the world frame. A moment that is not positive counts as "any": w
// stays constant.
void ob_spin_plan(ob_spin *spin, ob_quat q, ob_vec3 w, ob_vec3 inertia);

// Bound on the angular speed (rad/s), at any time, of a free body with attitude q and rate w.
double ob_spin_bound(ob_quat q, ob_vec3 w, ob_vec3 inertia);

// Bounds on the curvature of a point's path, per metre from the centre. The body turns freely at angular speeds of up
// to w (rad/s).
typedef struct ob_bending {
	ob_vec3 coupling; // c of Euler's equations b_i' = c_i b_j b_k, for the rate b in the frame of the body
	double most, jerk; // 1/s^2, 1/s^3: second and third derivative of the arm
} ob_bending;

ob_bending ob_bending_of(ob_vec3 inertia, double w);

// |q|^2 - 1 to the last digit, for a q that is nearly a unit quaternion.
double ob_quat_excess(ob_quat q);

// Attitude and rate (world frame) at s, which may be negative.
void ob_spin_at(ob_spin *spin, double s, ob_quat *q_out, ob_vec3 *w_out);
// Prepares the next ob_spin_at of n different rotations at an instant each, four side by side if they are long turns.
// Results are the same as without it.
void ob_spin_prepare(ob_spin *const *spin, const double *s, int n);

#endif
