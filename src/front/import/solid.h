// The shape with which a body of a model collides. Internal to the module.
#ifndef OB_IMPORT_SOLID_H
#define OB_IMPORT_SOLID_H

#include <stdio.h>

#include <ob/hull.h>
#include <ob/motion.h>

#include "import/load.h"

// A convex part of a hulled object, in the object's frame.
typedef struct ob_imported_piece {
	ob_vec3 half; // m, of a box; 0: a hull, or round
	ob_shape round; // sphere, capsule or cylinder; OB_SHAPE_NONE: not round
	ob_vec3 size; // m, of a round shape, as of ob_shape
	ob_pose pose; // of a box, or a round shape
	uint32_t points; // corners
	ob_vec3 point[OB_HULL_CORNERS_MAX]; // m
	double inside; // m, by which the hull stays inside the shapes that it stands for; 0: exact
} ob_imported_piece;

// A shape of obsim's, in the frame of an object.
typedef struct ob_imported_solid {
	ob_shape shape; // OB_SHAPE_NONE: none
	ob_vec3 size; // m, as of ob_shape; a hulled object has its pieces instead
	ob_pose pose; // of the object: centre of mass, axes; world
	ob_vec3 inertia; // kg m^2, about these axes
	uint32_t pieces; // 1: a hull, or a round part; more: a compound
	ob_imported_piece *piece; // lives as long as the process
	ob_hull *hull; // of all pieces; of a compound, theirs follow. NULL: not hulled
	double inside; // m, the most of its pieces
	uint32_t geoms; // number that it stands for
} ob_imported_solid;

// True if its pieces are the parts of a compound.
static inline bool ob_solid_is_compound(const ob_imported_solid *s)
{
	return s->pieces > 1 || (s->pieces && s->piece->round);
}

// True if the geometry touches others.
bool ob_geom_collides(const mjModel *m, int geom);
// False for planes, height fields, and meshes without vertices.
bool ob_geom_has_extent(const mjModel *m, int geom);
// Support point of a geometry along n, both in the world (m). It has an extent.
ob_vec3 ob_geom_farthest(const ob_drawn *d, int geom, ob_vec3 n);
// Shape of a body that moves: its only geometry's if the body's centre of mass and principal axes are that shape's; else
// a hull, or a compound with a part for each that collides, or the hull of them all if they are too many for a
// compound. OB_SHAPE_NONE if none collides, or the centre of mass is not well inside their hull.
void ob_solid_of_body(const ob_drawn *d, int body, ob_imported_solid *out);
// Shape of a geometry that stands still.
void ob_solid_of_geom(const ob_drawn *d, int geom, ob_imported_solid *out);

#endif
