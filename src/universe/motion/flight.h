// Evaluates a published motion at the present, and finds the first contact of a flying shape with a plane. Pure
// functions, thread-safe.
#ifndef OB_MOTION_FLIGHT_H
#define OB_MOTION_FLIGHT_H

#include <ob/hull.h>
#include <ob/motion.h>

#include "motion/spin.h"

// Motion of the centre alone at time t (s): m, m/s, m/s^2, as in ob_motion_at.
ob_vec3 ob_centre_at(const ob_motion *m, double t);
ob_vec3 ob_velocity_at(const ob_motion *m, double t);
ob_vec3 ob_acceleration_at(const ob_motion *m, double t);

// True if the object rests at time t (s) where its motion m begins.
bool ob_published_stands(const ob_motion *m, const ob_passport *p, double t);
// State at time t: ob_motion_at, but with the published bits if the object rests.
ob_state ob_published_at(const ob_motion *m, const ob_passport *p, double t);

// Rotations that are computed side by side, as each takes longer than all else of a state. n is 0 at first.
enum { OB_TURNS = 16 };
typedef struct ob_turns {
	size_t row[OB_TURNS]; // the caller's
	double s[OB_TURNS]; // since the motion's instant
	ob_spin spin[OB_TURNS], *of[OB_TURNS];
	int n;
} ob_turns;

// Adds the rotation of a motion, at a time (s). Returns true if there is room for no more before ob_turns_find.
bool ob_turns_add(ob_turns *t, size_t row, const ob_motion *m, const ob_passport *p, double time);
// Finds attitudes and rates (rad/s) of all that were added, and empties t; rows stay until the next is added. Returns their
// number, OB_TURNS at most.
int ob_turns_find(ob_turns *t, ob_quat *q, ob_vec3 *w);

// ob_published_at of n objects, with their rotations side by side. Of one that is absent, all of it 0, the state is 0.
void ob_published_all(const ob_motion *m, const ob_passport *p, uint32_t n, double t, ob_state *out);

typedef struct ob_flier {
	ob_shape shape; // OB_SHAPE_NONE: anything within size.x of the centre
	ob_vec3 size; // m
	ob_vec3 inertia; // kg m^2, principal; all 0: rotation unknown
	ob_vec3 p, v, a; // at s = 0
	ob_quat q; // attitude at s = 0; constant if spin is NULL
	ob_vec3 w; // rad/s, world, at s = 0
	ob_spin *spin;
	const ob_hull *hull; // NULL unless the shape needs one
} ob_flier;

typedef struct ob_half_space {
	ob_vec3 normal; // unit, out of the solid
	double offset; // m: normal . x on the surface
} ob_half_space;

// First instant in [from, until] (s, both finite) at which a point of the shape is on the plane and closes; infinity:
// none. A closing point within rounding of the plane at "from" gives "from" itself.
//
// Spheres: closed form. Boxes, hulls, capsules and cylinders: conservative advancement of their corners and rims
// (Mirtich 1996). Each corner has a curve that bounds its fall; the search runs only while the bounding sphere is on
// the plane. It takes two or three evaluations of the spin, to 1e-11 m. Other shapes: the instant when the bounding
// sphere reaches the plane, "from" if it already has.
double ob_landing_time(const ob_flier *f, const ob_half_space *plane, double from, double until);

enum { OB_LANDINGS = 16 };

typedef struct ob_landing {
	const ob_flier *flier; // each with a spin of its own, if any
	const ob_half_space *plane;
	double from, until;
	double time; // result, as ob_landing_time
} ob_landing;

// Landing times of up to OB_LANDINGS flights: follows their rotations, and the corners of boxes, side by side.
void ob_landing_times(ob_landing *of, int n);

#endif
