// Which point of a convex shape lies farthest along a direction, and along which direction two shapes are farthest
// apart (or overlap least). Pure functions, thread-safe.
#ifndef OB_CONTACT_SUPPORT_H
#define OB_CONTACT_SUPPORT_H

#include "contact/manifold.h"

// The point of the shape that lies farthest along n (world; need not be of unit length). Boxes, cylinders, capsules,
// hulls.
ob_vec3 ob_support(const ob_placed *x, ob_vec3 n);

// How far the shape reaches from its centre along n, times n's length (m): a convex function of n.
double ob_reach(const ob_placed *x, ob_vec3 n);

// From b's farthest point along n to a's farthest against it: the gradient of the separation along n.
ob_vec3 ob_support_between(const ob_placed *a, const ob_placed *b, ob_vec3 n);

// How far the shapes are apart along the unit direction n, from b to a (m): never more than their distance.
double ob_apart_along(const ob_placed *a, const ob_placed *b, ob_vec3 n);

// The best direction across the unit vector e, uphill from "from": of the two shapes seen along e, the nearest features
// (a circle's or an ellipse's arc and a corner, an edge or another arc). The separation of two convex shapes that are
// apart has one maximum on the half circle; the zero of its derivative is bracketed and found to rounding.
ob_vec3 ob_climb_across(const ob_placed *a, const ob_placed *b, ob_vec3 e, ob_vec3 from);

// The best direction for two rims, uphill from "from": Newton's method on the sphere of directions.
ob_vec3 ob_climb_rims(const ob_placed *a, const ob_placed *b, ob_vec3 from);

#endif
