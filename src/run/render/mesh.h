// Meshes of the shapes. A vertex is a corner of the core (in units of the core's half size) and a normal, along which
// the ball that thickens the core is added: position = corner * core + normal * radius. So a cylinder has bevelled
// edges, and a sphere is a capsule whose core is a point. A box is all core: twelve triangles.
#ifndef OB_RENDER_MESH_H
#define OB_RENDER_MESH_H

#include <stdbool.h>
#include <stdint.h>

#include <ob/hull.h>

typedef struct ob_vertex {
	float corner[3], normal[3];
} ob_vertex;

enum { OB_MESH_LEVELS = 3 }; // levels of detail, coarse to fine
typedef enum ob_mesh_kind {
	OB_MESH_BOX,
	OB_MESH_PATTERNED_BOX, // the same triangles, drawn with a pattern
	OB_MESH_ROUND, // sphere, capsule
	OB_MESH_CYLINDER = OB_MESH_ROUND + OB_MESH_LEVELS,
	OB_MESHES = OB_MESH_CYLINDER + OB_MESH_LEVELS,
} ob_mesh_kind;

// Range of one mesh in the shared arrays.
typedef struct ob_mesh_range {
	uint32_t index_first, index_count;
} ob_mesh_range;

typedef struct ob_mesh_set {
	ob_vertex *vertex;
	uint16_t *index;
	uint32_t vertices, indices;
	ob_mesh_range mesh[OB_MESHES];
} ob_mesh_set;

bool ob_mesh_set_build(ob_mesh_set *s); // counter-clockwise from outside; false: out of memory
void ob_mesh_set_finish(ob_mesh_set *s);

// Faces of a hull as triangles, three vertices each, in metres, counter-clockwise from outside. Returns the number of
// vertices. NULL: counts only.
uint32_t ob_mesh_of_hull(const ob_hull *h, ob_vertex *vertex);

#endif
