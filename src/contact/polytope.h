// Contacts of hulls with planes, boxes and hulls. The decisions are those for boxes (boxes.h), for any polyhedron. Axes
// are the normals of faces, and those of two edges that are a face of the Minkowski difference (the arcs of their
// normals cross: Gregorius 2013). Among several separating axes the one that closes last decides. A face's points are
// the other's face, clipped. Pure functions, thread-safe.
//
// out: as for ob_manifold_find. The separation is that of the best axis: a lower bound of the distance.
#ifndef OB_CONTACT_POLYTOPE_H
#define OB_CONTACT_POLYTOPE_H

#include "contact/manifold.h"

void ob_manifold_hull_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// Shapes: each a hull or a box.
void ob_manifold_polytopes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// Convex polygon over a plane: u and w in the plane, z above it (m); counterclockwise or clockwise.
enum { OB_POLYGON_MAX = 2 * OB_HULL_CORNERS_MAX };
typedef struct ob_polygon {
	double u[OB_POLYGON_MAX], w[OB_POLYGON_MAX], z[OB_POLYGON_MAX];
	int n;
} ob_polygon;

// Keeps the four points that span the largest area, among those within "band" (m) of the lowest one, or else the four
// lowest.
void ob_polygon_reduce(ob_polygon *p, double band);
// Returns the four of n points (at most 32) that span the largest area and include one of the deepest: a bit for each.
// tie: m, difference of depth that counts as none.
unsigned ob_widest_four(const double *u, const double *w, const double *z, int n, double tie);

#endif
