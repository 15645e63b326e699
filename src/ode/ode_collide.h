// Contact geometry by ODE's dCollide, for the shapes that contact/ has no closed form for (capsules, cylinders).
#ifndef OB_ODE_COLLIDE_H
#define OB_ODE_COLLIDE_H

#include <ob/motion.h>

typedef struct ob_ode_point {
	ob_vec3 position; // m, world, midway
	ob_vec3 normal;   // unit, from b to a
	double gap;       // m; < 0 penetrates
} ob_ode_point;

// Points with a gap below margin (m), the deepest first, then those farthest from the points before them. dCollide knows
// only overlap, so both shapes are inflated by margin / 2, and the points are brought back to the true surfaces.
// Returns 0 .. max (<= 8).
//
//   plane    with all but a plane: sphere 1 point, capsule 1 standing, 2 lying; box 4; cylinder 4 standing, 2 lying
//   sphere   with all: 1 point
//   box      with box up to 8; capsule 1, 2 lying flat; cylinder up to 8 on a cap, 2 on its side
//   capsule  with capsule or cylinder 1, 2 where they lie along each other or flat on a cap
//   cylinder with cylinder up to 8 where caps meet, 1 elsewhere
//
// With spheres, capsules and planes the gap is exact. Boxes with boxes: along ODE's normal, which is a face's unless an
// edge is 5 % better. Cylinders with boxes and cylinders: 1e-4 of their size.
// Pure: thread-safe, the same bits everywhere, after ob_ode_thread_init.
int ob_ode_collide(ob_shape sa, ob_vec3 size_a, ob_pose pa, ob_shape sb, ob_vec3 size_b, ob_pose pb, double margin,
		   ob_ode_point *out, int max);

#endif
