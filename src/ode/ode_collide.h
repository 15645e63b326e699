// Contact geometry by ODE's dCollide, for the shapes that contact/ has no closed form for (capsules, cylinders).
#ifndef OB_ODE_COLLIDE_H
#define OB_ODE_COLLIDE_H

#include <ob/motion.h>

typedef struct ob_ode_point {
	ob_vec3 position; // m, world, midway
	ob_vec3 normal;   // unit, from b to a
	double gap;       // m; < 0 penetrates
} ob_ode_point;

// Points with a gap below margin (m). dCollide knows only overlap, so both shapes are inflated by margin / 2 and
// the exact growth of their supports along the normal is taken off again. Returns 0 .. max (<= 8).
// Planes, spheres, boxes, capsules, cylinders in any combination but plane-plane. Pure: thread-safe, same bits everywhere.
int ob_ode_collide(ob_shape sa, ob_vec3 size_a, ob_pose pa, ob_shape sb, ob_vec3 size_b, ob_pose pb, double margin,
		   ob_ode_point *out, int max);

#endif
