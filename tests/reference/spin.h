// Torque-free rotation of a rigid body in long double, by a method independent of motion/. Rates: Jacobi's elliptic
// functions (Landau and Lifshitz 1976, Mechanics, section 37) from the arithmetic-geometric mean (Abramowitz and Stegun
// 1964, 16.4) and Carlson's integral (Carlson 1979, Numer. Math. 33, 1). Attitude: integrates the rate of turn about
// the momentum as a Fourier series, which the trapezoid rule gives to the last digit (Trefethen and Weideman 2014, SIAM
// Review 56, 385). Pure functions, thread-safe.
#ifndef OB_REFERENCE_SPIN_H
#define OB_REFERENCE_SPIN_H

#include <stdbool.h>

#include <ob/vec.h>

enum { OB_REFERENCE_HARMONICS = 512, OB_REFERENCE_MEANS = 16 };

typedef struct ob_reference_spin {
	bool steady; // turns at constant w
	long double q[4]; // at t = 0, body to world
	long double w[3]; // at t = 0, rad/s, in the frame of the sorted axes; in the world frame if steady
	int axis[3]; // component i in the sorted frame is sign[i] times component axis[i] of the body
	int sign[3];
	long double moment[3]; // sorted, kg m^2
	long double rate[3]; // amplitudes of cn, sn, dn in the rates, rad/s
	long double momentum; // its size, kg m^2/s
	long double kc; // complementary modulus
	long double mean[OB_REFERENCE_MEANS], half[OB_REFERENCE_MEANS]; // a and c of the arithmetic-geometric mean
	int means;
	long double quarter; // K: a quarter of the elliptic functions' period
	long double phase, speed; // their argument at t = 0, and its growth in 1/s
	long double turn; // mean rate of turn about the momentum, rad/s
	long double wave[OB_REFERENCE_HARMONICS]; // k: amplitude of sin(k pi u / K) in the turn, rad
	int harmonics;
	long double frame[3][3]; // frame of the momentum at t = 0, to the world
} ob_reference_spin;

// q: body to world; w: rad/s, world frame; inertia: principal moments, positive.
void ob_reference_spin_plan(ob_reference_spin *s, ob_quat q, ob_vec3 w, ob_vec3 inertia);
void ob_reference_spin_at(const ob_reference_spin *s, double t, ob_quat *q_out, ob_vec3 *w_out);

// rad: angle of the turn from one attitude to the other, 2 acos |<a, b>|, to full precision for small turns
double ob_reference_turn_between(ob_quat a, ob_quat b);

#endif
