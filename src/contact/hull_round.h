// Hulls against spheres and capsules: a segment, or a point, that is grown by its radius. The nearest points of segment
// and polyhedron in closed form: an end and a face, or the segment and an edge. Pure functions, thread-safe.
//
// out as of ob_manifold_find: the normal points to a, the sphere or capsule; the separation is the distance itself
// while the segment is outside the hull. What rolls or slides over coplanar faces meets no seam, as on boxes.
#ifndef OB_CONTACT_HULL_ROUND_H
#define OB_CONTACT_HULL_ROUND_H

#include "contact/manifold.h"

void ob_manifold_round_hull(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
