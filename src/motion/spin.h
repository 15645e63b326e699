// Torque-free rotation of a rigid body, evaluated at any time: over a short one by Magnus's expansion (magnus.h), over
// a long one in closed form, whose constants are computed when they are first asked for. What comes out follows from
// what the rotation was planned with and from the time alone. Pure functions but for that, so a plan is of one thread.
// Units: rad/s, kg m^2, s.
#ifndef OB_MOTION_SPIN_H
#define OB_MOTION_SPIN_H

#include <stdbool.h>

#include <ob/vec.h>

typedef enum ob_spin_kind {
	OB_SPIN_TURNS, // symmetric tops, spin about a principal axis, rest: two turns at constant rates
	OB_SPIN_THETA, // three different moments
} ob_spin_kind;

// The constants of OB_SPIN_THETA, in the frame of the sorted axes where nothing else is said: numbers that lie side by
// side, of which four rotations' are turned over into lanes.
enum {
	OB_THETA_START = 0, // attitude at s = 0
	OB_THETA_RATE = 4, // momentum / moment along each axis of the body for a unit direction, rad/s
	OB_THETA_AMPLITUDE = 7, // of cn, sn, dn in the direction of the momentum
	OB_THETA_M = 10, // parameter of the elliptic functions k^2, 1 - k^2, and sqrt(k')
	OB_THETA_MC,
	OB_THETA_ROOT_KC,
	OB_THETA_PHASE, // rad, rad/s: argument of the theta functions
	OB_THETA_SPEED,
	OB_THETA_PRECESSION, // rad/s, mean rate of turn about the momentum
	OB_THETA_SIDE, // +1 or -1: sign of the imaginary shift
	OB_THETA_COS0, // direction that the azimuth about the momentum has at s = 0
	OB_THETA_SIN0,
	OB_THETA_LIFT, // turn of the momentum's direction at s = 0 to the third axis
	OB_THETA_FRAME = OB_THETA_LIFT + 4, // the body's axes by the sorted ones, a matrix by rows: 0, 1 and -1
	OB_THETA_CONSTANTS = OB_THETA_FRAME + 9,
};

enum { OB_THETA_TERMS = 20 }; // enough for a complementary modulus down to 1e-16, where the nome is .88

// The series of theta_1 and theta_2 at v and of theta_1 at v + i alpha, with their common factor 2 q^(1/4) left out
// (and e^alpha / 2 more for the complex one): every use takes ratios or directions only.
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
	double fastest; // rad/s, at any time, or more
	double last; // s, that was asked for last, and the answer
	ob_quat last_q;
	ob_vec3 last_w;

	// OB_SPIN_TURNS: about a fixed axis of the world, after a turn about a fixed axis of the body
	ob_vec3 world; // rad/s, world frame
	ob_vec3 body; // rad/s, body frame

	// OB_SPIN_THETA
	double theta[OB_THETA_CONSTANTS];
	ob_theta_series series;
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
// Makes ready what ob_spin_at is asked for next, of n different rotations at an instant each: four side by side where
// they are long. It gives what it would have given without that.
void ob_spin_prepare(ob_spin *const *spin, const double *s, int n);

#endif
