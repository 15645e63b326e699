// Contacts of boxes and other polyhedra: limits that both share, and points of a polygon that hold as all of it does. Pure
// functions, thread-safe.
#ifndef OB_CONTACT_POLYTOPE_H
#define OB_CONTACT_POLYTOPE_H

#include "contact/manifold.h"

// Decisions about boxes and other polyhedra.
static const double same_axis = .99; // cosine: axes that count as one
static const double same_gap = 1e-9; // fraction of the thickness: axes this near to closing at one instant do
static const double along_face = .99; // cosine: an axis of edges this near counts as a face's normal
// Fraction of the thickness by which an axis of edges must separate more than a face's. The resting depth limits it:
// bodies get that deep before the edge holds them.
static const double prefer_face = 1e-3;
static const double prefer_face_when_deep = .02; // fraction of the depth, in addition
static const double nearby = .05; // fraction of the thickness: shapes farther apart need no axes of edges
static const double parallel_edges = 1e-10; // sin^2 of the edges' angle
static const double same_depth = 1e-4; // relative to half the thickness: points that count as equally deep

// Box or hull in world axes, from an origin that both of a pair share. Corners and faces stay in the shape's own frame;
// vectors are turned into it for comparison, since most corners are never needed in the world.
typedef struct ob_polytope {
	const ob_placed *placed;
	const ob_hull *shape; // topology, and normals of the faces
	const ob_vec3 *corner; // m, from the centre
	const double *offset; // m, of each face from the centre
	ob_vec3 centre;
	double inner, radius, thin; // m: see ob_hull
	ob_vec3 box_corner[8];
	double box_offset[6];
} ob_polytope;

static inline double ob_polytope_radius(const ob_placed *x)
{
	return x->hull ? x->hull->radius : ob_norm(x->size);
}

// Sets up a box or a hull, which stays in use. origin: m, world.
void ob_polytope_init(ob_polytope *x, const ob_placed *from, ob_vec3 origin);

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
