// Long rotations (motion/spin.h) of up to four bodies side by side, with the bits that each body has alone. For
// processors with AVX2 and FMA. Pure functions but for the rotations that they are given.
#ifndef OB_MOTION_SPIN_LANES_H
#define OB_MOTION_SPIN_LANES_H

#include "elementary/lanes.h"
#include "motion/spin.h"

// What the constants of OB_SPIN_THETA follow from, along the sorted axes.
typedef struct ob_theta_start {
	double size, direction[3]; // of the momentum, kg m^2/s
	double inertia[3], unused; // kg m^2
} ob_theta_start;

// n: 1 .. OB_LANES, of kind OB_SPIN_THETA all
void ob_spin_lanes_plan(ob_spin *const *spin, const ob_theta_start *from, int n);
// .. and planned; sets what was asked for last.
void ob_spin_lanes_turn(ob_spin *const *spin, const double *s, int n);

#endif
