// Cylinders against what they can meet: exact convex solids with a disc for a cap, a line for a side and a circle for a
// rim, never polygons. Planes and spheres in closed form. Against a box, a capsule or another cylinder the directions
// are tried along which two of their features can touch: the cap's and the faces' normals, those across the axis and an
// edge or another axis, and the best of those across each axis and each edge, where an arc meets a corner, an edge or
// an arc (contact/support.h); two rims by Newton's method. Pure functions, thread-safe.
//
// out as of ob_manifold_find: the normal points to a, the cylinder. The separation is the distance where it is no more
// than the margin, but for a rim beside a box's corner, where it is a lower bound. Of several directions that separate
// the shapes, the one that closes last is the normal, as between boxes.
#ifndef OB_CONTACT_CYLINDER_H
#define OB_CONTACT_CYLINDER_H

#include "contact/manifold.h"

void ob_manifold_cylinder_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_cylinder_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// b: a box, a capsule, another cylinder or a hull.
void ob_manifold_cylinder_edged(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
