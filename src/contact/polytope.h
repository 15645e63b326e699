// Points of a convex polygon that hold as the whole of it does. Pure functions, thread-safe.
#ifndef OB_CONTACT_POLYTOPE_H
#define OB_CONTACT_POLYTOPE_H

#include <ob/hull.h>

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
