// A scene while its file runs: what the calls of the file have declared so far. One per load, owned by scene.c.
// The files call_*.c hold the functions that a scene can call.
#ifndef OB_SCENE_BUILDER_H
#define OB_SCENE_BUILDER_H

#include <limits.h>

#include "scene/fields.h"
#include "scene/random.h"
#include "scene/scene.h"

#define OB_SCENE_OBJECTS_MAX 1000000
#define OB_SCENE_OBJECT_INSTRUCTIONS 100 // what a file may use more for each object that it adds: of the Lua machine ..
#define OB_SCENE_OBJECT_SECONDS 20e-6 // .. and of time
#define OB_SCENE_MESH_NAME_MAX 256 // bytes, with the final 0
#define OB_SCENE_MATERIALS_MAX 256
#define OB_SCENE_CAMERAS_MAX 64
#define OB_SCENE_PARAMS_MAX 64

typedef struct ob_material {
	char name[OB_NAME_MAX];
	double friction, restitution; // NaN, also in colour[0]: not given
	double roughness, metal;
	double density; // kg/m^3
	float colour[4];
} ob_material;

// A camera that has no eye of its own looks from a direction, and is put where it sees all objects.
typedef struct ob_camera_draft {
	ob_camera_def def;
	bool framed;
	ob_vec3 from; // unit, from the objects towards the eye
} ob_camera_draft;

// What a mesh is made of.
typedef struct ob_mesh_source {
	const char *file;
	double scale;
	ob_pose pose; // of the file's frame in the body's
} ob_mesh_source;

typedef struct ob_builder {
	ob_scene *scene; // objects are added to it; its room for them:
	uint32_t objects_room;
	uint32_t hulls_room;
	uint64_t *hull_points; // [scene->hulls], hashes of the points that each was made of
	const ob_scene_options *options;
	bool has_scene; // scene { ... } was called
	ob_material material[OB_SCENE_MATERIALS_MAX];
	uint32_t materials;
	ob_camera_draft camera[OB_SCENE_CAMERAS_MAX];
	uint32_t cameras;
	char param[OB_SCENE_PARAMS_MAX][OB_NAME_MAX]; // names that the scene asked for
	uint32_t params;
	uint32_t states_room;
	const char *path; // of the scene, from where files of scripts are found; NULL: there are none
	ob_random random;
	bool random_used;
} ob_builder;

// Adds an object with its own name, or, where name is NULL, one made of its kind and id ("box#12").
ob_object_def *ob_builder_add(lua_State *L, ob_builder *b, const char *kind, const char *name);
// The object's path from the table at the top of the stack, and its first state. kind: of the call, for messages.
void ob_builder_read_path(lua_State *L, const char *kind, ob_object_def *o);
// The same for a force that changes in time.
void ob_builder_read_force(lua_State *L, const char *kind, ob_object_def *o);
// NULL where no material has this name.
const ob_material *ob_builder_material(const ob_builder *b, const char *name);

// The path of a file that lies with the scene. Raises an error where the name leads elsewhere, as the field of "where".
void ob_builder_find_file(lua_State *L, const ob_builder *b, const char *where, const char *field, const char *name,
			  char path[PATH_MAX]);
// 1 + the number of the scene's mesh from this source, which is read where it is new. Raises an error where it is none.
uint8_t ob_builder_mesh(lua_State *L, ob_builder *b, const char *where, const ob_mesh_source *source);
// The number of the script that an object's field `script` says, which is made where it is new. Raises an error where
// it is none.
uint32_t ob_builder_script(lua_State *L, ob_builder *b, const char *where, const char *script);
// Keeps an object's state; its place in the scene's states.
uint32_t ob_builder_keep_state(lua_State *L, ob_builder *b, const unsigned char *bytes, uint32_t size);

// lua_CFunctions
int ob_scene_call_script(lua_State *L);
int ob_scene_call_scene(lua_State *L);
int ob_scene_call_record(lua_State *L);
int ob_scene_call_sky(lua_State *L);
int ob_scene_call_sun(lua_State *L);
int ob_scene_call_ground(lua_State *L);
int ob_scene_call_material(lua_State *L);
int ob_scene_call_camera(lua_State *L);
int ob_scene_call_box(lua_State *L);
int ob_scene_call_hull(lua_State *L);
int ob_scene_call_sphere(lua_State *L);
int ob_scene_call_capsule(lua_State *L);
int ob_scene_call_cylinder(lua_State *L);
int ob_scene_call_plane(lua_State *L);
int ob_scene_call_param(lua_State *L);
int ob_scene_call_random(lua_State *L);
int ob_scene_call_random_rotation(lua_State *L);
int ob_scene_call_random_integer(lua_State *L); // math.random

// Every -D was asked for; false and e otherwise.
bool ob_builder_check_defines(const ob_builder *b, const char *path, ob_error *e);
// Moves the cameras into the scene, placing those that frame all objects. false where there is no memory.
bool ob_builder_place_cameras(ob_builder *b);

#endif
