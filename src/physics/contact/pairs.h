// Pairs of shapes with the functions that find their contacts: one line a pair. For contact/manifold.c.
//
// Each function is as ob_manifold_find, for shapes in the order of its line. The separation is that of the best
// direction: the distance itself between round shapes, a lower bound of it elsewhere. Among several separating
// directions of edged shapes the one that closes last is the normal. Pure functions, thread-safe.
#ifndef OB_CONTACT_PAIRS_H
#define OB_CONTACT_PAIRS_H

#include "contact/manifold.h"

#define OB_PAIRS(PAIR) \
	PAIR(SPHERE, SPHERE, ob_manifold_spheres) \
	PAIR(SPHERE, PLANE, ob_manifold_sphere_plane) \
	PAIR(SPHERE, BOX, ob_manifold_round_hull) \
	PAIR(SPHERE, HULL, ob_manifold_round_hull) \
	PAIR(BOX, PLANE, ob_manifold_box_plane) \
	PAIR(BOX, BOX, ob_manifold_boxes) \
	PAIR(BOX, HULL, ob_manifold_polytopes) \
	PAIR(CAPSULE, PLANE, ob_manifold_capsule_plane) \
	PAIR(CAPSULE, SPHERE, ob_manifold_capsule_sphere) \
	PAIR(CAPSULE, BOX, ob_manifold_round_hull) \
	PAIR(CAPSULE, CAPSULE, ob_manifold_capsules) \
	PAIR(CAPSULE, HULL, ob_manifold_round_hull) \
	PAIR(CYLINDER, PLANE, ob_manifold_cylinder_plane) \
	PAIR(CYLINDER, SPHERE, ob_manifold_cylinder_sphere) \
	PAIR(CYLINDER, BOX, ob_manifold_cylinder_edged) \
	PAIR(CYLINDER, CAPSULE, ob_manifold_cylinder_edged) \
	PAIR(CYLINDER, CYLINDER, ob_manifold_cylinder_edged) \
	PAIR(CYLINDER, HULL, ob_manifold_cylinder_edged) \
	PAIR(HULL, PLANE, ob_manifold_hull_plane) \
	PAIR(HULL, HULL, ob_manifold_polytopes) \
	PAIR(SPHERE, TERRAIN, ob_manifold_terrain) \
	PAIR(BOX, TERRAIN, ob_manifold_terrain) \
	PAIR(CAPSULE, TERRAIN, ob_manifold_terrain) \
	PAIR(CYLINDER, TERRAIN, ob_manifold_terrain) \
	PAIR(HULL, TERRAIN, ob_manifold_terrain)

void ob_manifold_spheres(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_sphere_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_round_hull(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_box_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_boxes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_polytopes(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsule_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsule_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_capsules(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_cylinder_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_cylinder_sphere(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_cylinder_edged(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
// b: its hull is an ob_terrain_part.
void ob_manifold_terrain(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);
void ob_manifold_hull_plane(const ob_placed *a, const ob_placed *b, double margin, ob_manifold *out);

#endif
