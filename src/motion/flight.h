// What a published motion says of the present, and when a flying shape first touches a plane. Pure functions,
// thread-safe.
#ifndef OB_MOTION_FLIGHT_H
#define OB_MOTION_FLIGHT_H

#include <ob/hull.h>
#include <ob/motion.h>

#include "motion/spin.h"

// Of its centre alone at time t (s): m, m/s, m/s^2, as ob_motion_at has them.
ob_vec3 ob_centre_at(const ob_motion *m, double t);
ob_vec3 ob_velocity_at(const ob_motion *m, double t);
ob_vec3 ob_acceleration_at(const ob_motion *m, double t);

// Does the object stand at time t (s) where its motion m begins?
bool ob_published_stands(const ob_motion *m, const ob_passport *p, double t);
// Its state then: ob_motion_at, but with the bits as published where the object stands.
ob_state ob_published_at(const ob_motion *m, const ob_passport *p, double t);

typedef struct ob_flier {
	ob_shape shape; // OB_SHAPE_NONE: anything within size.x of the centre
	ob_vec3 size; // m
	ob_vec3 inertia; // kg m^2, principal; all 0: nothing is known of how it turns
	ob_vec3 p, v, a; // at s = 0
	ob_quat q; // attitude at s = 0, which stays where spin is NULL
	ob_vec3 w; // rad/s, world, at s = 0
	ob_spin *spin;
	const ob_hull *hull; // of a hull
} ob_flier;

typedef struct ob_half_space {
	ob_vec3 normal; // unit, out of the solid
	double offset; // m: normal . x on the surface
} ob_half_space;

// The first instant in [from, until] (s, both finite) at which a point of the shape is on the plane and closes;
// infinity: none is. A point that is within rounding of the plane at "from" and closes gives "from" itself. Spheres in
// closed form; boxes, hulls, capsules and cylinders by conservative advancement of their corners and rims (Mirtich
// 1996), each with a curve that bounds its fall, and only while the bounding sphere is on the plane: two or three
// evaluations of the spin, and 1e-11 m. Anything else: when its bounding sphere does, and at once where it has.
double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until);

enum { OB_LANDINGS = 16 };

typedef struct ob_landing {
	const ob_flier *flier; // each with a spin of its own, if any
	const ob_half_space *plane;
	double from, until;
	double time; // what ob_landing_time gives
} ob_landing;

// Of up to OB_LANDINGS flights: their rotations, and the corners of boxes, are followed side by side.
void ob_landing_times(ob_landing *of, int n);

#endif
