// Convex hulls: the shape of an object that is made of points. A universe holds each hull once; objects share it. Pure
// functions, thread-safe.
#ifndef OB_HULL_H
#define OB_HULL_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/motion.h>

#pragma GCC visibility push(default) // libobsim exports the declarations of its installed headers alone

enum { // limits for a polyhedron with so many corners (Euler)
	OB_HULL_CORNERS_MAX = 64,
	OB_HULL_FACES_MAX = 2 * OB_HULL_CORNERS_MAX - 4,
	OB_HULL_EDGES_MAX = 3 * OB_HULL_CORNERS_MAX - 6,
	OB_HULL_PARTS_MAX = 15, // convex parts of a compound
};

typedef struct ob_hull_edge {
	uint8_t from, to; // corners
	uint8_t left, right; // faces: left has the edge as from -> to, counterclockwise seen from outside
} ob_hull_edge;

// Convex hull in the body's frame: the origin is the centre of mass, the axes are the principal ones. It contains no
// pointers, so it lies in the universe as it is.
//
// A compound is a body of several convex parts. Its hull holds them all, and is what planes touch; volume, moments and
// frame are those of the parts, the thickness is the least of theirs. The hulls of its parts follow it by number, in the
// compound's frame: the origin may lie outside a part.
//
// A part may be a sphere, a capsule or a cylinder. Then its polyhedron is its look: corners on its surface. The compound's
// own hull is then a box about its parts, and planes touch each part.
typedef struct ob_hull {
	uint32_t corners, faces, edges; // 4 .., 4 .., 6 ..
	uint16_t parts; // of a compound: so many hulls after this one; 0: the body is this hull
	uint16_t is_part; // 1: of a compound
	double radius; // m, of the smallest ball about the origin that contains it
	// m, of the largest ball about the origin inside it; < 0, where the origin is outside: minus a bound of its distance
	double inner;
	double thickness; // m, least width
	double volume; // m^3
	ob_vec3 inertia; // m^2, principal moments per kilogram; a part's are about its own centre
	ob_vec3 centre; // m, the origin in the frame of the original points; a part's own centre in the compound's frame
	ob_quat frame; // body's frame to that of the original points; a part's principal frame to the compound's
	uint32_t round; // of a round part: its ob_shape; of a compound: number of such parts
	uint32_t zero;
	ob_vec3 size; // of a round part: see ob_shape; about its own centre and frame
	ob_vec3 corner[OB_HULL_CORNERS_MAX]; // m
	ob_vec3 normal[OB_HULL_FACES_MAX]; // unit, outward
	double offset[OB_HULL_FACES_MAX]; // m, distance of the face from the origin
	uint16_t first[OB_HULL_FACES_MAX + 4]; // face f is loop[first[f]] .. loop[first[f + 1] - 1]
	uint8_t loop[2 * OB_HULL_EDGES_MAX + 4]; // corners, counterclockwise seen from outside
	ob_hull_edge edge[OB_HULL_EDGES_MAX];
} ob_hull;

// True if the numbers of a hull from outside are plausible: counts, indices, finite numbers.
bool ob_hull_makes_sense(const ob_hull *h);

// Copies a hull of a universe, by the number in body properties; it never changes. Returns false if it does not exist
// or its numbers are implausible.
bool ob_universe_get_hull(const ob_universe *u, uint32_t hull, ob_hull *out);

// Tight axis-aligned box (xmin ymin zmin xmax ymax zmax, m) at a pose.
void ob_hull_bounds(const ob_hull *h, ob_pose pose, double bounds[6]);

#pragma GCC visibility pop

#endif
