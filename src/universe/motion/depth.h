// Penetration depth of two convex solids: the length of the shortest way out. Pure, thread-safe.
#ifndef OB_MOTION_DEPTH_H
#define OB_MOTION_DEPTH_H

#include <ob/hull.h>
#include <ob/motion.h>

typedef struct ob_solid {
	ob_shape shape;
	ob_vec3 size; // m, see ob_shape
	ob_vec3 p; // m, centre
	ob_mat3 r; // body to world
	const ob_hull *hull; // NULL unless the shape needs one
} ob_solid;

// Returns the solid of an object, or of its part; a round part is a solid of its own shape. hull: the part's, or the
// object's; NULL: it has none.
ob_solid ob_solid_of(ob_shape shape, ob_vec3 size, ob_pose pose, const ob_hull *hull);

// Depth (m); <= 0: no overlap, and its negative is a lower bound of the distance. Closed forms, exact to rounding, for
// spheres, capsules, planes and boxes in any pair but two planes (-infinity), and for cylinders with spheres and
// planes. Boxes use separating axes (Gottschalk, Lin and Manocha 1996). Hulls with all but cylinders have closed forms,
// too (depth.c). Cylinders with boxes, capsules, hulls and cylinders: ob_depth_search.
double ob_depth(const ob_solid *a, const ob_solid *b);

// True if the depth of two such solids has no closed form, or one that costs as much as a search.
bool ob_depth_needs_search(ob_shape a, ob_shape b);

// Same for any two solids but planes, by a search over directions for the least overlap of their projections. Every
// direction gives an upper bound, so the result is never too small; it is too large by less than 1e-7 of their size.
double ob_depth_search(const ob_solid *a, const ob_solid *b);

// Extent (m) of the solid from its centre along the unit direction n: its support function. Not for planes.
double ob_solid_extent(const ob_solid *s, ob_vec3 n);

#endif
