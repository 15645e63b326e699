// Contact manifolds: a normal and up to four points with their gaps, for two shapes that touch or nearly do. Also the
// time at which two moving shapes first touch. Pure functions, thread-safe.
#ifndef OB_CONTACT_MANIFOLD_H
#define OB_CONTACT_MANIFOLD_H

#include <ob/hull.h>
#include <ob/motion.h>

#include "motion/spin.h"

typedef struct ob_placed {
	ob_shape shape;
	ob_vec3 size;
	ob_vec3 p; // m
	ob_mat3 r; // body to world
	ob_vec3 v; // m/s: decides along which of several separating axes the shapes meet first
	ob_vec3 w; // rad/s
	ob_vec3 inertia; // kg m^2, principal; all 0: w stays constant (motion/drift.h)
	double rest_depth; // m: penetration permitted between bodies that rest or slide on each other
	// s: a gap that closes later counts as open until the next check. Much longer than a step, so that rounding
	// does not count as closing; 0: any closing counts
	double far_future;
	ob_vec3 a; // m/s^2, external acceleration: a standing cylinder has a point where it presses most on the rim
	const ob_hull *hull; // NULL unless the shape needs one; a round part's body has its shape, size, pose and rates
} ob_placed;

// Returns the shape itself, or in "room" that of a round part, in its own frame, with the velocity of its centre.
const ob_placed *ob_placed_own(const ob_placed *x, ob_placed *room);

typedef struct ob_manifold {
	ob_vec3 normal; // unit, from b to a; without points a separating axis, or 0 if none is known
	int points; // 0 .. 4
	ob_vec3 at[4]; // m, world, midway between the surfaces
	double gap[4]; // m along the normal; < 0 penetrates
	// m: radius of a contact disc about the points' mean; the points lie on its rim. 0: the contact area is the
	// points' convex hull. < 0: a disc leans there, and touches with the first point alone. A finder receives 0, and
	// sets it for a disc only.
	double disc_radius;
	double separation; // m, lower bound of the distance if positive; otherwise minus the depth
	// m, path of both bodies together after which the manifold is found again; infinity, unless a finder knows that
	// it changes sooner
	double valid_path;
	uint32_t pieces; // of a terrain, each tested as a hull of its own; a finder receives 0
} ob_manifold;

// Finds points with a gap up to margin (m). The caller sets out->disc_radius and out->pieces to 0 and out->valid_path to infinity.
// Returns false for shapes that do not know each other, as two planes: out then has no points, and an infinite
// separation.
bool ob_manifold_find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// Time (s) until a gap (m) that changes at this rate (m/s) has closed; at most the far future of the two.
static inline double ob_time_to_close(const ob_placed *a, const ob_placed *b, double gap, double rate)
{
	const double far = ob_min(a->far_future, b->far_future), latest = far > 0 ? far : INFINITY;
	return gap <= 0 ? 0 : rate < 0 ? ob_min(latest, -gap / rate) : latest;
}

// Collision test of two shapes. Without points, out->separation must be a lower bound of their distance.
typedef struct ob_manifold_finder {
	void (*find)(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
	void *with;
	bool of_boxes; // tests axis-aligned boxes in place of the shapes; they may touch although the shapes do not
} ob_manifold_finder;

// Time of impact by conservative advancement (Mirtich 1996), so that bodies do not tunnel between two collision tests.
// Both shapes move at their constant v and turn freely. An advance is bounded by the largest closing speed of any two
// points, or by the shapes' extents along a separating direction.
//
// Returns the first time in [0, h] (s) at which the shapes are within tolerance (m); out: points up to margin (m) as of
// that time. The margin is for points that turning about the first one brings down within the same step. Returns
// infinity if they do not touch; out then has no points, and separation is as of now. Beside fast rotation a search may
// need too many advances. If margin equals tolerance, it then returns a time until which they certainly do not touch,
// and no points. speed: upper bound on the closing speed of any two points (m/s) until then.
double ob_time_of_impact(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance,
			 double margin, ob_manifold_finder find, ob_manifold *out);

// Forecast of ob_time_of_impact, for as long as nothing is hit: first time in [0, h] (s) at which the shapes are within
// "near" (m), or nearly; infinity: none. A long search ends early, as it does beyond "soon" (s), with a time until
// which they certainly are not. apart: lower bound of their present distance (m).
double ob_time_of_nearing(const ob_placed *a, const ob_placed *b, double speed, double h, double soon, double near,
			  ob_manifold_finder find, double *apart);

// Rotation of a shape, as "spin" has it "since" (s) after its start. NULL: the shape keeps its attitude, or looks as
// if it did.
typedef struct ob_turning {
	ob_spin *spin;
	double since;
} ob_turning;

// Finds when two moving shapes first touch and then penetrate within h (s), to rounding. out: points up to margin (m)
// at that time. Shapes that touch now may part. when: infinity if they stay apart; out then has no points, and
// separation is as of now. Returns false if the search fails: the shapes overlap already, or need too many advances.
// when and out are then undefined.
bool ob_time_of_touch(const ob_placed *a, const ob_placed *b, const ob_turning turning[2], double h, double margin,
		      ob_manifold_finder find, double *when, ob_manifold *out);

#endif
