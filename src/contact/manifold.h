// Where two shapes touch, or are about to: a normal and up to four points with their gaps; and when two moving shapes
// first touch. Pure functions, thread-safe.
#ifndef OB_CONTACT_MANIFOLD_H
#define OB_CONTACT_MANIFOLD_H

#include <ob/motion.h>

typedef struct ob_placed {
	ob_shape shape;
	ob_vec3 size;
	ob_vec3 p; // m
	ob_mat3 r; // body to world
	ob_vec3 v; // m/s: decides along which of several separating axes the shapes will meet first
	ob_vec3 w; // rad/s
} ob_placed;

typedef struct ob_manifold {
	ob_vec3 normal; // unit, from b to a
	int points; // 0 .. 4
	ob_vec3 at[4]; // m, world, midway between the surfaces
	double gap[4]; // m along the normal; < 0 penetrates
	double separation; // m, lower bound of the distance when positive; minus the depth otherwise
} ob_manifold;

// Spheres, boxes and planes in any combination but plane-plane; points with a gap up to margin (m).
// false: the combination has no closed form here (capsules, cylinders), out is untouched.
bool ob_manifold_find(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// The two boxes' part of it: separating axes (Gottschalk et al. 1996), the axis chosen by the time at which it
// closes, face clipping (Sutherland and Hodgman 1974).
void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// A collision test of two shapes; out->separation must be a lower bound of their distance where there are none.
typedef struct ob_manifold_finder {
	void (*find)(void *with, const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
	void *with;
} ob_manifold_finder;

// Time of impact by conservative advancement (Mirtich 1996), so that nothing passes through anything between two
// collision tests: both shapes move at their constant v, w. Returns the first time in [0, h] (s) at which they are
// within tolerance (m), and in out the points up to margin (m) as of that time: what turns about the first point to
// touch brings the next ones down within the same step. Infinity if they do not touch; then out has no points, and
// separation is as of now. speed: bound of the closing speed of any two points (m/s).
double ob_time_of_impact(const ob_placed *a, const ob_placed *b, double speed, double h, double tolerance,
			 double margin, ob_manifold_finder find, ob_manifold *out);

#endif
