// Contact points of two flat facets that face each other: the face of a box or a hull, or the cap of a cylinder. A cap
// is a disc, not a polygon. Pure functions, thread-safe.
#ifndef OB_CONTACT_FACETS_H
#define OB_CONTACT_FACETS_H

#include "contact/manifold.h"

enum { OB_SPOTS_MAX = 32 };

typedef struct ob_spots {
	ob_vec3 normal; // unit, outward from the facet at which gaps begin
	double margin; // m: spots with a larger gap are left out
	double same; // m: nearer spots count as one
	int n;
	ob_vec3 at[OB_SPOTS_MAX]; // m, midway between the surfaces
	double gap[OB_SPOTS_MAX]; // m
	double disc_radius; // m, as ob_manifold.disc_radius
} ob_spots;

// Directions of four points on the cylinder's rim, a quarter apart. The first is where the cap reaches farthest along
// "towards". On a level cap it is where the external acceleration presses most, or else turns with the bodies.
void ob_rim_directions(const ob_placed *cylinder, const ob_placed *other, ob_vec3 towards, ob_vec3 direction[4]);

// Finds common points of the facet of "on" with the outward unit normal n, and of the shape "over" it. on: a plane, a
// box, a hull or a cylinder (its cap); over: a cylinder, a box, a hull or a capsule.
void ob_spots_find(const ob_placed *on, const ob_placed *over, ob_vec3 n, double margin, ob_spots *out);

// Finds the face of the box on which a rolls or slides across a seam, so that it does not hit the edge. The face is one
// that a touches, and that closes no sooner than their gap (m) in the direction n. wider: the box, with that face
// extended by reach (m). leaving: neither closes, as a leaves the face; it is then extended as far as the edge is no
// farther away than the face. Returns false if there is no such face.
bool ob_face_underfoot(const ob_placed *a, const ob_placed *box, ob_vec3 n, double gap, double reach, ob_placed *wider,
		       ob_vec3 *normal, bool *leaving);
// Path (m) after which two shapes are checked again if one has left a face.
double ob_leaving_path(const ob_placed *a, const ob_placed *b);

// Adds a point (m, midway), unless there is one at this place, or the gap exceeds the margin.
void ob_spots_add(ob_spots *s, ob_vec3 at, double gap);

// Keeps the four most important spots: the deepest, the farthest from it, and the widest to each side.
void ob_spots_reduce(ob_spots *s);

// Makes the spots the manifold's points. sign: 1 if the spots' normal points to a, -1 if it points to b.
void ob_spots_put(const ob_spots *s, double sign, ob_manifold *out);

#endif
