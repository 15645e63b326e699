// Hulls against planes, boxes and hulls. As between boxes (boxes.h), whose decisions these are for any polyhedron: the
// axes are the normals of faces, and those of two edges that are a face of the Minkowski difference (the arcs of their
// normals cross: Gregorius 2013); of several axes that separate, the one that closes last decides; a face's points are
// the other's face, clipped. Pure functions, thread-safe.
//
// out as of ob_manifold_find; the separation is that of the best axis: a lower bound of the distance.
#ifndef OB_CONTACT_POLYTOPE_H
#define OB_CONTACT_POLYTOPE_H

#include "contact/manifold.h"

void ob_manifold_hull_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// Each a hull or a box.
void ob_manifold_polytopes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

// A convex polygon in a plane: u and w in it, z above it (m); counterclockwise or clockwise.
enum { OB_POLYGON_MAX = 2 * OB_HULL_CORNERS_MAX };
typedef struct ob_polygon {
	double u[OB_POLYGON_MAX], w[OB_POLYGON_MAX], z[OB_POLYGON_MAX];
	int n;
} ob_polygon;

// Keeps four points at most, of those that are as low as the lowest within "band" (m), or else the four lowest: those
// that span most.
void ob_polygon_reduce(ob_polygon *p, double band);
// Of n points (at most 32): a bit for each of the four that span the largest area with one of the deepest, to tie, among
// them.
unsigned ob_widest_four(const double *u, const double *w, const double *z, int n, double tie);

#endif
