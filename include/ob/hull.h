// Convex hulls: the shape of an object that is made of points. A universe holds each hull once, however many objects have
// it. Pure functions, thread-safe.
#ifndef OB_HULL_H
#define OB_HULL_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/motion.h>

#pragma GCC visibility push(default) // libobsim shows what its installed headers declare, nothing else

enum { // of a polyhedron with so many corners (Euler)
	OB_HULL_CORNERS_MAX = 64,
	OB_HULL_FACES_MAX = 2 * OB_HULL_CORNERS_MAX - 4,
	OB_HULL_EDGES_MAX = 3 * OB_HULL_CORNERS_MAX - 6,
};

typedef struct ob_hull_edge {
	uint8_t from, to;    // corners
	uint8_t left, right; // faces: left has the edge as from -> to, counterclockwise seen from outside
} ob_hull_edge;

// In the body's frame: the origin is the centre of mass, the axes are the principal ones. No pointers: it lies in the
// universe as it is.
typedef struct ob_hull {
	uint32_t corners, faces, edges; // 4 .., 4 .., 6 ..
	uint32_t zero;
	double radius;    // m, of the sphere round the origin that holds it
	double inner;     // m, of the sphere round the origin that it holds
	double thickness; // m, its least width
	double volume;    // m^3
	ob_vec3 inertia;  // m^2, principal moments of a kilogram of it
	ob_vec3 centre;   // m, the origin as whoever gave the points sees it ..
	ob_quat frame;    // .. and the body's frame to theirs
	ob_vec3 corner[OB_HULL_CORNERS_MAX]; // m
	ob_vec3 normal[OB_HULL_FACES_MAX];   // unit, outward
	double offset[OB_HULL_FACES_MAX];    // m, of the face from the origin
	uint16_t first[OB_HULL_FACES_MAX + 4]; // face f is loop[first[f]] .. loop[first[f + 1] - 1]
	uint8_t loop[2 * OB_HULL_EDGES_MAX + 4]; // corners, counterclockwise seen from outside
	ob_hull_edge edge[OB_HULL_EDGES_MAX];
} ob_hull;

// Whether the numbers of a hull that came from outside could be those of one: counts, indices, finite numbers.
bool ob_hull_makes_sense(const ob_hull *h);

// A hull of a universe, by the number that passports bear; it never changes. false: there is none, or its numbers do not
// make sense.
bool ob_universe_get_hull(const ob_universe *u, uint32_t hull, ob_hull *out);

// Tight axis-aligned box (xmin ymin zmin xmax ymax zmax, m) at a pose.
void ob_hull_bounds(const ob_hull *h, ob_pose pose, double bounds[6]);

#pragma GCC visibility pop

#endif
