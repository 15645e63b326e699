// Support functions of convex shapes, and the direction along which two shapes are farthest apart, or overlap least.
// Pure functions, thread-safe.
#ifndef OB_CONTACT_SUPPORT_H
#define OB_CONTACT_SUPPORT_H

#include "contact/manifold.h"
#include "shape/part.h"

// Support point: the farthest point of the shape along n (world frame, any length). Boxes, cylinders, capsules, hulls.
ob_vec3 ob_support(const ob_placed *x, ob_vec3 n);

// Middle of the shape (m): its centre, or of a compound's part that is round or does not hold the body's centre, its own.
static inline ob_vec3 ob_middle(const ob_placed *x)
{
	return x->hull && (x->hull->inner < 0 || ob_part_is_round(x->hull))
		       ? ob_add(x->p, ob_rotate(&x->r, x->hull->centre))
		       : x->p;
}

// Extent of the shape from its centre along n, times the length of n (m): a convex function of n.
double ob_reach(const ob_placed *x, ob_vec3 n);

// Vector from b's support point along n to a's against n (m): the gradient of the separation along n.
ob_vec3 ob_support_between(const ob_placed *a, const ob_placed *b, ob_vec3 n);

// Separation of the shapes along the unit direction n, from b to a (m): never more than their distance.
double ob_apart_along(const ob_placed *a, const ob_placed *b, ob_vec3 n);

// Climbs from "from" to the direction of largest separation across the unit vector e. As seen along e, the nearest
// features there are an arc of a circle or an ellipse, and a corner, an edge or another arc. If two convex shapes are
// apart, their separation has one maximum on the half circle. The zero of its derivative is bracketed, and found to
// rounding.
ob_vec3 ob_climb_across(const ob_placed *a, const ob_placed *b, ob_vec3 e, ob_vec3 from);

// Climbs from "from" to the direction of largest separation of two rims: Newton's method on the sphere of directions.
ob_vec3 ob_climb_rims(const ob_placed *a, const ob_placed *b, ob_vec3 from);

#endif
