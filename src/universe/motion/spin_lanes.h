// Long rotations (motion/spin.h) of up to four bodies side by side; each lane has the bits of a single body. For
// processors with AVX2 and FMA. Pure functions except for the rotations passed to them.
#ifndef OB_MOTION_SPIN_LANES_H
#define OB_MOTION_SPIN_LANES_H

#include "elementary/lanes.h"
#include "motion/spin.h"

// Input of the constants of OB_SPIN_THETA, along the sorted axes.
typedef struct ob_theta_start {
	double size, direction[3]; // the momentum, kg m^2/s
	double inertia[3], unused; // kg m^2
} ob_theta_start;

// n: 1 .. OB_LANES, all of kind OB_SPIN_THETA.
void ob_spin_lanes_plan(ob_spin *const *spin, const ob_theta_start *from, int n);
// Turns planned rotations; sets the last instant and its result.
void ob_spin_lanes_turn(ob_spin *const *spin, const double *s, int n);

#endif
