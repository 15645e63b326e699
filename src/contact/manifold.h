// Where two shapes touch, or are about to: a normal and up to four points with their gaps; and when two moving shapes
// first touch. Pure functions, thread-safe.
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
	ob_vec3 v; // m/s: decides along which of several separating axes the shapes will meet first
	ob_vec3 w; // rad/s
	ob_vec3 inertia; // kg m^2, principal: how w goes on (motion/drift.h); all 0: it stays
	double rest_depth; // m: bodies at rest on each other, or sliding, may be so deep in each other
	double far_future; // s: what does not close within so long stays open until it is looked at again. Much longer
			   // than a step, so that rounding does not count as closing; 0: any closing counts
	ob_vec3 a; // m/s^2, external acceleration: towards where on its rim a standing cylinder is pressed most
	const ob_hull *hull; // of a hull
} ob_placed;

typedef struct ob_manifold {
	ob_vec3 normal; // unit, from b to a; where there are no points, if it is set at all, along which they are
			// separate
	int points; // 0 .. 4
	ob_vec3 at[4]; // m, world, midway between the surfaces
	double gap[4]; // m along the normal; < 0 penetrates
	// m: they touch all over a disc of this radius about the points' mean, of which the points stand for the rim.
	// 0: over the points' hull. Whoever finds a manifold sets it only where there is a disc, and is given 0.
	double disc_radius;
	double separation; // m, lower bound of the distance when positive; minus the depth otherwise
	double valid_path; // m, of both together, after which it is to be found anew: set by those who know that it
			   // changes soon, infinity before
} ob_manifold;

// out->disc_radius is 0 and out->valid_path is infinite when a finder is called: see there.
//
// Points with a gap up to margin (m). false: two planes, or nothing at all; out is untouched.
bool ob_manifold_find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// s: until a gap (m) that changes at this rate (m/s) has closed; at most the far future of the two.
static inline double ob_time_to_close(const ob_placed *a, const ob_placed *b, double gap, double rate)
{
	const double far = ob_min(a->far_future, b->far_future), latest = far > 0 ? far : INFINITY;
	return gap <= 0 ? 0 : rate < 0 ? ob_min(latest, -gap / rate) : latest;
}

// The two boxes' part of it: separating axes (Gottschalk et al. 1996), the axis chosen by the time at which it
// closes, face clipping (Sutherland and Hodgman 1974).
void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// A collision test of two shapes; out->separation must be a lower bound of their distance where there are none.
typedef struct ob_manifold_finder {
	void (*find)(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
	void *with;
	bool of_boxes; // of axis-aligned ones in place of the shapes, which may touch where the shapes do not
} ob_manifold_finder;

// Time of impact by conservative advancement (Mirtich 1996), so that nothing passes through anything between two
// collision tests: both shapes move at their constant v and turn freely. They advance to where they may touch by the
// speed at which any two points close at most, or by how the shapes reach along a direction that separates them.
// Returns the first time in [0, h] (s) at which they are within tolerance (m), and in out the points up to margin (m)
// as of that time: what turns about the first point to touch brings the next ones down within the same step. Infinity
// if they do not touch; then out has no points, and separation is as of now. So it is where margin is tolerance and too
// many advances would be needed, beside what turns fast: then the time is that until which they certainly do not touch.
// speed: bound of the closing speed of any two points (m/s) until then.
double ob_time_of_impact(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance,
			 double margin, ob_manifold_finder find, ob_manifold *out);

// A forecast of the same, for as long as nothing is hit: the first time in [0, h] (s) at which the two are within
// "near" (m), or nearly; infinity if they are not. Where it would take many advances to know, and beyond "soon" (s),
// the time is that until which they certainly are not. apart: m, their distance now, at least.
double ob_time_of_nearing(const ob_placed *a, const ob_placed *b, double speed, double h, double soon, double near,
			  ob_manifold_finder find, double *apart);

// How a shape turns: as this rotation does, "since" (s) after it began. NULL: it does not, or cannot be seen to.
typedef struct ob_turning {
	ob_spin *spin;
	double since;
} ob_turning;

// When two that move so first touch and go on into each other within h (s), to rounding, and in out the points up to
// margin (m) then. Those that touch now may part. when: infinity, if they stay apart; then out has no points, and
// separation is as of now. false: it could not be found, because they are in each other, or shapes or motions ask for
// too many advances; then when and out mean nothing.
bool ob_time_of_touch(const ob_placed *a, const ob_placed *b, const ob_turning turning[2], double h, double margin,
		      ob_manifold_finder find, double *when, ob_manifold *out);

#endif
