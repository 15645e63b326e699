// How a box falls on a plane (motion/landing.c), of up to four side by side, with the bits that each has alone. For
// processors with AVX2. Pure functions.
#ifndef OB_MOTION_LANDING_LANES_H
#define OB_MOTION_LANDING_LANES_H

#include <stdbool.h>

#include <ob/vec.h>

// A box at an instant of its flight: numbers alone, which are turned over into lanes.
typedef struct ob_falling_box {
	ob_vec3 half; // m
	ob_quat q;
	ob_vec3 w; // rad/s, world
	ob_vec3 normal; // of the plane
	ob_vec3 coupling; // of Euler's equations, see ob_bending
	double height, speed, a; // m, m/s, m/s^2: of the centre, over the plane
	double most, jerk; // m/s^2, m/s^3: how any corner may fall
	double tolerance; // m
	double left; // s, until nobody asks any more
	double unused;
} ob_falling_box;

// For how long no corner lands, at least (s); lands: one does then. n: 1 .. 4
void ob_landing_lanes_advance(const ob_falling_box *box, int n, double *t, bool *lands);

#endif
