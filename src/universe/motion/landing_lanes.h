// Landing of boxes on a plane (motion/landing.c), up to four side by side; each lane has the bits of a single box. For
// processors with AVX2. Pure functions.
#ifndef OB_MOTION_LANDING_LANES_H
#define OB_MOTION_LANDING_LANES_H

#include <stdbool.h>

#include <ob/vec.h>

// Box at an instant of its flight: numbers alone, transposed into lanes.
typedef struct ob_falling_box {
	ob_vec3 half; // m
	ob_quat q;
	ob_vec3 w; // rad/s, world
	ob_vec3 normal; // of the plane
	ob_vec3 coupling; // coefficients of Euler's equations, see ob_bending
	double height, speed, a; // m, m/s, m/s^2: the centre, over the plane
	double most, jerk; // m/s^2, m/s^3: bounds for any corner
	double tolerance; // m
	double left; // s, remaining time of the search
	double unused;
} ob_falling_box;

// Lower bounds (s) of the time until a corner lands; lands: one does then. n: 1 .. 4
void ob_landing_lanes_advance(const ob_falling_box *box, int n, double *t, bool *lands);

#endif
