// Contents of a picture at one instant, without OpenGL: the view of the camera, the bodies' poses, instances of those
// that pass a test (frustum culling, say), and the segments of overlays. One thread at a time per list.
#ifndef OB_RENDER_DRAW_LIST_H
#define OB_RENDER_DRAW_LIST_H

#include "measure/colouring.h"
#include "mesh/mesh.h"
#include "render/mesh.h"
#include "scene/scene.h"

// ---- the view of a camera: its axes and frustum. Double precision; pure functions

typedef struct ob_view {
	ob_vec3 eye; // m
	ob_vec3 right, up, forward; // unit
	double tan_x, tan_y; // tangents of half the angles of view
	double near_plane, far_plane; // m
	double range; // m, from the eye to its target: the scale of the picture
} ob_view;

// View of the camera at time t (s): travelled, panned and tilted since 0.
ob_view ob_view_of_camera(const ob_camera_def *c, double t, int width, int height);
// View of a camera sensor, from its pose: it looks along x, z is up.
ob_view ob_view_of_sensor(const ob_sensor_passport *s, ob_pose at);
// True if the ball (centre, radius in m) is at least partly in the frustum.
bool ob_view_in_frustum(const ob_view *v, ob_vec3 centre, double radius);
// Column-major matrix from positions relative to the eye to clip coordinates. y points down the picture, so that the
// first row read back is the top one; counter-clockwise triangles become clockwise.
void ob_view_projection(const ob_view *v, float m[16]);

// ---- bodies

enum { OB_PLANES_MAX = 16 };

// An object's share in the decision of an automatic camera: 1 while it moves, less and less while it rests.
typedef struct ob_attention {
	uint32_t generation;
	float level; // 0: none yet
} ob_attention;

typedef enum ob_drawn {
	OB_DRAWN_SOLID,
	OB_DRAWN_THROUGH, // a sensor: what is behind it shines through, and it casts no shadow
	OB_DRAWN_NOT, // cameras may follow it
} ob_drawn;

typedef struct ob_draw_item {
	ob_pose pose;
	double radius; // m, of its bounding sphere
	double distance; // m, squared, from the eye; set by ob_draw_list_sort
	uint32_t id; // index into the snapshot
	ob_drawn drawn;
} ob_draw_item;

typedef struct ob_draw_list {
	const ob_mesh *mesh; // [meshes] of the scene: set once, before the first fill
	uint32_t meshes;
	ob_colouring colouring; // likewise
	const ob_snapshot *now;
	ob_draw_item *body;
	uint32_t count, capacity;
	ob_pose plane[OB_PLANES_MAX];
	uint32_t plane_id[OB_PLANES_MAX];
	int planes;
	ob_attention *attention; // [capacity], by id
	double time; // s, of the last fill
} ob_draw_list;

// Instance data as the shaders read it (shaders/instance.glsl). 64 bytes.
typedef struct ob_instance {
	float position_radius[4]; // m: centre relative to the eye; radius of the ball that thickens the core
	float attitude[4]; // x y z w
	// m: half size; width of a box's rounded edges, 0 = not a box. Negative for a mesh: -1 = shown with its
	// colours, -2 = with its surface; or, of an exact shape, -1 = a sphere or capsule, -2 = a cylinder
	float core[4];
	// linear, or the object's number; last: 15 times its metal, whole, plus its roughness, below 1, plus 16 times its pattern
	float colour[4];
} ob_instance;

// Instances grouped by mesh: those of mesh k are first[k] .. first[k + 1] - 1. Order of meshes: the shapes', the
// snapshot's hulls, the scene's.
typedef struct ob_instances {
	ob_instance *instance;
	uint32_t meshes;
	uint32_t *first; // [meshes + 1]
	uint32_t capacity, meshes_max;
	bool exact; // set by the owner: shapes without bevels, of the finest meshes, with numbers for colours
} ob_instances;

// Evaluates all motions at time t (s); prev may be NULL. b starts zeroed. Fills with growing times carry attention on,
// in steps of up to a second. Returns false if memory runs out.
// Pose of an object of the snapshot at time t, likewise.
ob_pose ob_draw_pose(const ob_snapshot *prev, const ob_snapshot *now, uint32_t id, double t);
bool ob_draw_list_fill(ob_draw_list *b, const ob_snapshot *prev, const ob_snapshot *now, double t);
// Moves an automatic camera so that it sees the moving bodies in a picture of this shape, from above level ground; and
// one that follows an object, with it. Returns any other unchanged. Smooth in the bodies' positions.
ob_camera_def ob_camera_follow(const ob_camera_def *c, const ob_draw_list *b, int width, int height);
// Nearest to the eye first, so that hidden surfaces are not shaded.
void ob_draw_list_sort(ob_draw_list *b, ob_vec3 eye);
void ob_draw_list_finish(ob_draw_list *b);

// Filter: called with each body; true = draw it.
typedef bool (*ob_draw_filter)(const ob_draw_item *body, const void *context);
// Fills out with the bodies that pass. out starts zeroed. Returns false if memory runs out.
bool ob_instances_fill(ob_instances *out, const ob_draw_list *b, const ob_view *v, int height, ob_draw_filter filter,
		       const void *context);
void ob_instances_finish(ob_instances *i);

// ---- overlays: bounding boxes, contacts, readings and joints, as lines and dots of constant width on the screen

// Layout of shaders/segment.vert. 44 bytes.
typedef struct ob_segment {
	float from[3], to[3]; // m, relative to the eye; equal: a dot
	float colour[4]; // displayed colour (sRGB), alpha
	float width; // px
} ob_segment;

typedef struct ob_overlay {
	ob_segment *segment;
	size_t count, capacity;
} ob_overlay;

// Each replaces the contents of o, which starts zeroed. Returns false if memory runs out.
bool ob_overlay_boxes(ob_overlay *o, const ob_draw_list *b, const ob_view *v);
bool ob_overlay_contacts(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height);
// Lines between objects that read each other's motions: their bounds in the snapshot overlap. reader: one alone; "" = all.
bool ob_overlay_reads(ob_overlay *o, const ob_draw_list *b, const ob_view *v, const char *reader);
bool ob_overlay_joints(ob_overlay *o, const ob_snapshot *s, const ob_view *v, int height);
void ob_overlay_finish(ob_overlay *o);

#endif
