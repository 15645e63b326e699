// A scene while its file runs: the declarations so far. One per load, owned by scene.c. The files call_*.c hold the
// functions that a scene can call.
#ifndef OB_SCENE_BUILDER_H
#define OB_SCENE_BUILDER_H

#include <limits.h>

#include "fmu/archive.h"
#include "scene/fields.h"
#include "scene/random.h"
#include "scene/scene.h"

#define OB_SCENE_OBJECTS_MAX 1000000
#define OB_SCENE_OBJECT_INSTRUCTIONS 100 // Lua instructions, in addition, for each object that a file adds
#define OB_SCENE_MESH_NAME_MAX 256 // bytes, with the final 0
#define OB_SCENE_MATERIALS_MAX 256
#define OB_SCENE_CAMERAS_MAX 64
#define OB_SCENE_PARAMS_MAX 64
#define OB_SCENE_CONTROLS_MAX 32

typedef struct ob_material {
	char name[OB_NAME_MAX];
	double friction, restitution; // NaN, also in colour[0]: not set
	double roughness, metal;
	double density; // kg/m^3
	double update_rate; // Hz
	float colour[4];
	uint32_t pattern; // ob_pattern; OB_PATTERNS: not set
} ob_material;

// A camera without an eye of its own has a direction, and is placed where it sees all objects.
typedef struct ob_camera_draft {
	ob_camera_def def;
	bool framed;
	ob_vec3 from; // unit, from the objects towards the eye
} ob_camera_draft;

// Source of a mesh.
typedef struct ob_mesh_source {
	const char *file;
	double scale;
	ob_pose pose; // pose of the file's frame in the body's
} ob_mesh_source;

typedef struct ob_builder {
	ob_scene *scene; // objects are added to it; room is the array's length:
	uint32_t objects_room, joints_room, sensors_room;
	uint32_t hulls_room;
	uint64_t *hull_points; // [scene->hulls], hashes of their points
	const ob_scene_options *options;
	bool has_scene; // scene { ... } was called
	int settings_line; // where it was called
	ob_material material[OB_SCENE_MATERIALS_MAX];
	uint32_t materials;
	ob_camera_draft camera[OB_SCENE_CAMERAS_MAX];
	uint32_t cameras;
	char param[OB_SCENE_PARAMS_MAX][OB_NAME_MAX]; // names that the scene requested
	uint32_t params;
	uint32_t states_room;
	uint32_t fmus; // files read:
	struct {
		char name[OB_NAME_MAX];
		ob_fmu_file file;
	} fmu[OB_SCENE_FMUS_MAX];
	const char *path; // the scene's path, to find files of scripts; NULL: there are none
	ob_random random;
	bool random_used;
} ob_builder;

// Adds an object with its own name, or, if name is NULL, one made of its kind and id ("box#12").
ob_object_def *ob_builder_add(lua_State *L, ob_builder *b, const char *kind, const char *name);
// Sets the object's path from the table at the top of the stack, and its first state. kind: name of the call, for
// messages.
void ob_builder_read_path(lua_State *L, const char *kind, ob_object_def *o);
// Reads the points of a path from the field "points" of the table at the top of the stack; returns their number. They lie in a
// value of Lua's, which is pushed. begins: the first has the time 0; else points that follow another one. where: for messages.
uint32_t ob_builder_read_points(lua_State *L, const char *where, bool begins, ob_path_point **out, bool *turns);
// The same as ob_builder_read_path for a force that changes in time.
void ob_builder_read_force(lua_State *L, const char *kind, ob_object_def *o);
// NULL if no material has this name.
const ob_material *ob_builder_material(const ob_builder *b, const char *name);

// Finds the path of a file in the scene's folder. Raises an error if the name leads elsewhere, as the field of "where".
void ob_builder_find_file(lua_State *L, const ob_builder *b, const char *where, const char *field, const char *name,
			  char path[PATH_MAX]);
// 1 + the number of the scene's mesh from this source, which is read if it is new. Raises an error if it is invalid.
// field: the one that names the file.
uint8_t ob_builder_mesh(lua_State *L, ob_builder *b, const char *where, const char *field,
			const ob_mesh_source *source);
// Raises an error if the looks of the scene are too large.
void ob_builder_check_looks(lua_State *L, const ob_scene *s, const char *where);
// Raises an error if so much more memory is beyond the budget (base/budget.h).
void ob_builder_allow(lua_State *L, const char *where, uint64_t bytes);
// Makes room for one more element than "count", of a list that scenes make long. Raises an error if there is none.
#define OB_BUILDER_MAKE_ROOM(L, where, array, count, room) \
	ob_builder_make_room(L, where, &(array), count, &(room), sizeof *(array))
void ob_builder_make_room(lua_State *L, const char *where, void *array, uint32_t count, uint32_t *room, size_t size);
// Number of the script in an object's field `script`, which is added if it is new. Raises an error if it is invalid.
uint32_t ob_builder_script(lua_State *L, ob_builder *b, const char *where, const char *script);
// Adds a script, and takes ownership of its text, from malloc; NULL: no memory. Raises an error if there are too many.
uint32_t ob_builder_add_script(lua_State *L, ob_builder *b, const char *where, const char *name, char *text,
			       size_t size);
// Number of the script for the fields `fmu`, `inputs` and `outputs` of the table at index 1, which is added if it is new.
// The starts of its `parameters` become the object's state. Raises an error if one is invalid.
uint32_t ob_builder_fmu(lua_State *L, ob_builder *b, const char *where, const char *name, uint32_t *state_at,
			uint32_t *state_bytes);
// Stores an object's state; returns its offset in the scene's states.
uint32_t ob_builder_keep_state(lua_State *L, ob_builder *b, const unsigned char *bytes, uint32_t size);

// lua_CFunctions
int ob_scene_call_script(lua_State *L);
int ob_scene_call_scene(lua_State *L);
int ob_scene_call_record(lua_State *L);
int ob_scene_call_sky(lua_State *L);
int ob_scene_call_sun(lua_State *L);
int ob_scene_call_ground(lua_State *L);
int ob_scene_call_compound(lua_State *L);
int ob_scene_call_heightfield(lua_State *L);
int ob_scene_call_mesh(lua_State *L);
int ob_scene_call_material(lua_State *L);
int ob_scene_call_camera(lua_State *L);
int ob_scene_call_param(lua_State *L);
int ob_scene_call_controls(lua_State *L);
int ob_scene_call_random(lua_State *L);
int ob_scene_call_random_rotation(lua_State *L);
int ob_scene_call_joint(lua_State *L); // upvalue 1: the kind; likewise:
int ob_scene_call_sensor(lua_State *L);
void ob_expected_open(lua_State *L); // offers the library "lab" to the table at the top of the stack
int ob_scene_call_case(lua_State *L);
int ob_scene_call_expect(lua_State *L);
int ob_scene_call_watch(lua_State *L);
int ob_scene_call_random_integer(lua_State *L); // math.random

// Finds the object of this name, of those declared so far; it must be there from the start. kind: name of the call.
void ob_builder_find_object(lua_State *L, const ob_scene *s, const char *kind, const char *name, ob_joined *to);
// The shortest rotation from +z to the unit vector n.
ob_quat ob_scene_turn_to(ob_vec3 n);
// Adds an object of this shape from the table at the bottom of the stack; pushes its name. Returns 1.
int ob_scene_add(lua_State *L, ob_shape shape);
// Text after "name=" in the last -D of that name, which the scene has from now on; NULL: there is none.
const char *ob_builder_defined(lua_State *L, ob_builder *b, const char *name);
// Finds or adds the hull of these points; objects with the same points and moments share it. inertia: m^2, principal
// moments per kilogram; NAN: a homogeneous body's. It stays where it is until the next hull is added.
const ob_hull *ob_builder_hull(lua_State *L, ob_builder *b, const ob_points *p, ob_vec3 inertia);
// The same for a compound of the list of parts at the top of the stack; their hulls follow it. density: kg/m^3, their
// mean; NAN: they have none.
// Terrain of the fields size, cells and height of the table at index 1.
ob_terrain *ob_builder_heights(lua_State *L);
// Terrain of a file's triangles; *look: 1 + the number of its mesh.
ob_terrain *ob_builder_triangles(lua_State *L, ob_builder *b, const char *file, double scale, uint8_t *look);
// Adds a terrain, and frees it. *look: 1 + the number of its mesh; 0: it gets one. kind: name of the call, for messages.
// Returns its number.
uint32_t ob_builder_terrain(lua_State *L, ob_builder *b, const char *kind, ob_terrain *t, uint8_t *look);
const ob_hull *ob_builder_compound(lua_State *L, ob_builder *b, ob_vec3 inertia, double *density);

// Sets the tolerance if it is a share of the thinnest object's thickness; a scene in which nothing moves keeps the
// default. false and e: it would be out of its limits.
bool ob_builder_resolve_tolerance(ob_builder *b, const char *path, ob_error *e);
// True if the scene requested every -D; else false and e.
bool ob_builder_check_defines(const ob_builder *b, const char *path, ob_error *e);
// Moves the cameras into the scene, and places those that frame all objects. false and e: no memory, or one follows an
// object that never exists.
bool ob_builder_place_cameras(ob_builder *b, const char *path, ob_error *e);
// False and e if a control has nobody to send to: no object of that name, or no avatar.
bool ob_builder_check_controls(const ob_builder *b, const char *path, ob_error *e);

#endif
