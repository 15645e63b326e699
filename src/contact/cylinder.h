// Contacts of cylinders. They are exact convex solids with a disc for a cap, a line for a side and a circle for a rim,
// never polygons. Planes and spheres are in closed form. Against a box, a capsule, another cylinder or a hull, the
// search tries the directions along which two features can touch: normals of caps and faces, and those across the axis
// and an edge or another axis. Then it tries the best direction across each axis and each edge, along which an arc
// touches a corner, an edge or an arc (contact/support.h). Two rims take Newton's method. Pure functions, thread-safe.
//
// out: as for ob_manifold_find. The normal points to a, the cylinder. The separation is the distance if it is at most
// the margin; for a rim beside a box's corner it is a lower bound. Among several separating directions the one that
// closes last is the normal, as between boxes.
#ifndef OB_CONTACT_CYLINDER_H
#define OB_CONTACT_CYLINDER_H

#include "contact/manifold.h"

void ob_manifold_cylinder_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_cylinder_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// b: a box, a capsule, another cylinder or a hull.
void ob_manifold_cylinder_edged(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
