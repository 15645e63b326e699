// What a flat facet of one shape, the face of a box or the cap of a cylinder, and the facet of another that looks at it
// have in common: contact points. A cap is a disc, not a polygon. Pure functions, thread-safe.
#ifndef OB_CONTACT_FACETS_H
#define OB_CONTACT_FACETS_H

#include "contact/manifold.h"

enum { OB_SPOTS_MAX = 32 };

typedef struct ob_spots {
	ob_vec3 normal; // unit, out of the facet that the gaps are measured from
	double margin; // m: higher spots are left out
	double same; // m: so near to each other are two spots one
	int n;
	ob_vec3 at[OB_SPOTS_MAX]; // m, midway
	double gap[OB_SPOTS_MAX]; // m
	double disc_radius; // m: of the whole cap that stands on the other facet; 0: none does
} ob_spots;

// The directions of four places on the rim of the cylinder: the first is where the cap reaches farthest along
// "towards"; of a cap that looks straight there, where the external acceleration presses most, or else one that turns
// with the bodies.
void ob_rim_directions(const ob_placed *cylinder, const ob_placed *other, ob_vec3 towards, ob_vec3 direction[4]);

// Common points of shape "on" (a plane, a box, a hull, or a cylinder's cap), whose facet has the outward unit normal n,
// and of the cylinder, box, hull or capsule "over" it. axis: of on's frame, along n.
void ob_spots_find(const ob_placed *on, const ob_placed *over, ob_vec3 n, double margin, ob_spots *out);

// Seams: a face of the box that a touches, and that does not close before the direction n in which their gap (m) is,
// bears a: it rolls or slides from one coplanar face to the next, and the edge is not hit. wider: the box, with that
// face going on for reach (m), or, where neither closes and a leaves the face, as far as the edge is no farther away
// than the face.
bool ob_face_underfoot(const ob_placed *a, const ob_placed *box, ob_vec3 n, double gap, double reach, ob_placed *wider,
		       ob_vec3 *normal, bool *leaving);
// m: path after which shapes are looked at again of which one has left a face.
double ob_leaving_path(const ob_placed *a, const ob_placed *b);

// at: m, midway. Left out if it is there already, or higher than the margin.
void ob_spots_add(ob_spots *s, ob_vec3 at, double gap);

// The four that matter most: the deepest, the farthest from it, and the widest to each side.
void ob_spots_reduce(ob_spots *s);

// As the manifold's points; sign: 1 where the spots' normal points to a, -1 where it points to b.
void ob_spots_put(const ob_spots *s, double sign, ob_manifold *out);

#endif
