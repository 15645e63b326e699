// A snapshot seen at one instant: where each body is, ready to be drawn.
#ifndef OB_RENDER_BODIES_H
#define OB_RENDER_BODIES_H

#include "measure/measure.h"
#include "render/mesh.h"
#include "render/view.h"

enum { OB_PLANES_MAX = 16 };

typedef struct ob_render_body {
	ob_pose pose;
	double radius; // m, of the sphere that holds it
	double distance; // m, squared, from the eye; set by ob_bodies_sort
	uint32_t id; // index into the snapshot
} ob_render_body;

typedef struct ob_bodies {
	const ob_snapshot *now;
	ob_render_body *body;
	uint32_t count, capacity;
	ob_pose plane[OB_PLANES_MAX];
	uint32_t plane_id[OB_PLANES_MAX];
	int planes;
} ob_bodies;

// Instance data as the shaders read it (shaders/instance.glsl). 64 bytes.
typedef struct ob_instance {
	float position_radius[4]; // m: centre relative to the eye; radius of the ball that thickens the core
	float attitude[4]; // x y z w
	float core[4]; // m: half size; width of a box's rounded edges, 0 = not a box
	float colour[4];
} ob_instance;

// Instances grouped by mesh: those of mesh k are first[k] .. first[k + 1] - 1.
typedef struct ob_instances {
	ob_instance *instance;
	uint32_t first[OB_MESHES + 1];
	uint32_t capacity;
} ob_instances;

// Evaluates all motions at time t (s); prev may be NULL. false: out of memory. b starts zeroed.
bool ob_bodies_evaluate(ob_bodies *b, const ob_snapshot *prev, const ob_snapshot *now, double t);
// Nearest to the eye first, so that what is hidden is not shaded.
void ob_bodies_sort(ob_bodies *b, ob_vec3 eye);
void ob_bodies_finish(ob_bodies *b);

// Which bodies to take: called with each.
typedef bool (*ob_body_filter)(const ob_render_body *body, const void *context);
// Fills out with the bodies that pass. false: out of memory. out starts zeroed.
bool ob_instances_fill(ob_instances *out, const ob_bodies *b, const ob_view *v, int height, ob_body_filter filter,
		       const void *context);
void ob_instances_finish(ob_instances *i);

#endif
