// Contacts of hulls with spheres and capsules: a point or a segment, grown by its radius. The nearest points of segment
// and polyhedron are in closed form: an end and a face, or the segment and an edge. Pure functions, thread-safe.
//
// out: as for ob_manifold_find. The normal points to a, the sphere or capsule. The separation is the distance itself
// while the segment is outside the hull. A body that rolls or slides over coplanar faces hits no seam, as on boxes.
#ifndef OB_CONTACT_HULL_ROUND_H
#define OB_CONTACT_HULL_ROUND_H

#include "contact/manifold.h"

void ob_manifold_round_hull(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
