// Scenes: a Lua 5.4 file, run in a sandbox, becomes plain definitions. Nothing here knows how they are run.
#ifndef OB_SCENE_SCENE_H
#define OB_SCENE_SCENE_H

#include <ob/motion.h>

#include "hull/hull.h"
#include "mesh/mesh.h"
#include "motion/force.h"
#include "motion/path.h"
#include "settings/settings.h"

enum { OB_SCENE_HULLS_MAX = 4096 }; // different ones, with those that come while it runs

typedef struct ob_object_def {
	ob_passport passport; // id, name, flags, shape, size, mass, friction, restitution, colour; inertia is filled by the host
	ob_state state;       // at its first instant
	uint64_t look; // of what comes while the universe runs: key of the mesh that it looks like (ob_mesh.key); 0: none
	uint32_t script; // 1 + its number; 0: none
	uint32_t state_at, state_bytes; // of what its script begins with (scene/flat.h), in ob_scene.states
	ob_path *path;        // how a kinematic one moves; NULL: it goes on as it begins. The scene's, freed with it
	ob_force *force;      // that changes in time, beside the passport's; NULL: none. As path
	double born, dies;    // s; born = 0 and dies = infinity: there all the time
} ob_object_def;

typedef struct ob_camera_def {
	char name[OB_NAME_MAX];
	ob_vec3 eye, target;  // m, look-at
	ob_vec3 velocity;     // m/s, the eye and target travel (translate)
	double pan, tilt;     // rad/s, turning about the vertical and about the right-hand axis (pan-tilt)
	double fov;           // rad, vertical
	bool automatic;       // eye and target are where it begins; it goes along with what moves
} ob_camera_def;

typedef struct ob_look_def {
	float sky_top[3], sky_horizon[3]; // linear RGB, as all colours here
	float ground_colour[3];
	bool grid;            // lines on the ground each metre, stronger each ten
	ob_vec3 sun;          // direction towards the sun
} ob_look_def;

// A script of objects: its own file, or part of the scene.
typedef struct ob_script_def {
	char name[OB_NAME_MAX]; // for messages, and by which it is found
	char *text; // Lua, ends with a 0
	uint32_t size;
} ob_script_def;

enum { OB_SCENE_MESHES_MAX = 255 }; // as passports can name
#define OB_SCENE_MESH_BYTES (64u << 20) // of all meshes

typedef struct ob_scene {
	char title[128];
	ob_run_settings run;        // before what the command line asks for (ob_run_settings_resolve)
	double duration;            // s
	uint64_t seed;
	uint32_t objects;
	ob_object_def *object;      // [objects]; ids are their index
	uint32_t hulls;
	ob_hull *hull;              // [hulls], by the number in passports
	ob_hull_corners *hull_corners; // [hulls], as the scene gives them
	uint32_t meshes;
	ob_mesh *mesh;              // [meshes], by the number in passports, less 1; in the frame of the bodies
	uint32_t cameras;
	ob_camera_def *camera;      // at least one
	ob_look_def look;
	uint32_t record_every;      // steps between recorded states; 1 unless the scene says otherwise
	uint32_t scripts;
	ob_script_def *script; // [scripts]
	unsigned char *states; // of all objects' scripts
	uint32_t states_bytes;
	uint32_t room; // objects that scripts may have created at the same time
	char *text; // of its file: ob_scene_load_text makes the same scene of it
	size_t text_size;
} ob_scene;

typedef struct ob_scene_options {
	const char *const *defines; // "name=value" of -D
	uint32_t define_count;
	bool has_seed;
	uint64_t seed;              // replaces the scene's
	bool joining;               // its objects are for a universe that runs: their meshes are named (look), not read
} ob_scene_options;

// Reads, runs and checks a scene file; o may be NULL. NULL and e on error, in one line: "file:line: where.field:
// expected ..., got ..."; without a line where the file cannot be read or a -D does not fit. Any thread.
ob_scene *ob_scene_load(const char *path, const ob_scene_options *o, ob_error *e);
// The same of a text that is no file, or no longer; path is for its title and for messages.
ob_scene *ob_scene_load_text(const char *path, const char *text, size_t size, const ob_scene_options *o, ob_error *e);
void ob_scene_free(ob_scene *s);

// "#rrggbb" or "#rrggbbaa" as people write it, to linear RGB and alpha; false: it is neither.
bool ob_scene_read_colour(const char *text, float linear[4]);
// Appends what a word means, a number, true, false, or text, to the values of a message (scene/flat.h). false: it has no
// room.
bool ob_scene_put_value(const char *word, unsigned char *to, uint32_t *size, uint32_t room);

#define OB_SCENE_SCRIPT_BYTES (256 << 10) // of one script
#define OB_SCENE_ROOM_MAX 100000

#endif
