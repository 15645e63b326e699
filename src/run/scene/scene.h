// Scenes: a Lua 5.4 file, run in a sandbox, becomes plain definitions. Independent of the engines that run them.
#ifndef OB_SCENE_SCENE_H
#define OB_SCENE_SCENE_H

#include <ob/joint.h>
#include <ob/motion.h>
#include <ob/sensor.h>

#include "fmu/instance.h"
#include "hull/hull.h"
#include "mesh/mesh.h"
#include "terrain/terrain.h"
#include "motion/force.h"
#include "motion/path.h"
#include "settings/settings.h"

enum { OB_SCENE_HULLS_MAX = 4096 }; // different ones, including those added during the run

typedef struct ob_object_def {
	// id, name, flags, shape, size, mass, friction, restitution, colour; inertia, unless given, is filled by the host
	ob_passport passport;
	ob_state state; // at its first instant
	uint64_t look; // for an object added during the run: key of its mesh (ob_mesh.key); 0: none
	uint32_t script; // 1 + its number; 0: none
	uint32_t state_at, state_bytes; // its script's initial state (scene/flat.h), in ob_scene.states
	ob_path *path; // motion of a kinematic one; NULL: its initial motion continues. Owned by the scene
	ob_force *force; // time-dependent force, beside the passport's; NULL: none. Owned like path
	double update_rate; // Hz, of its simulator in a free run; 0: the run's
	double born, dies; // s; born = 0 and dies = infinity: always present
} ob_object_def;

typedef struct ob_camera_def {
	char name[OB_NAME_MAX];
	ob_vec3 eye, target; // m, look-at
	ob_vec3 velocity; // m/s, the eye and target travel (translate)
	double pan, tilt; // rad/s, turning about the vertical and about the right-hand axis (pan-tilt)
	double fov; // rad, vertical
	bool automatic; // eye and target are initial; the camera follows moving objects
	bool aboard; // eye and target lie in the axes of the object `follow`, and turn with it
	char follow[OB_NAME_MAX]; // object that the camera moves along with; "" = none
} ob_camera_def;

typedef struct ob_look_def {
	float sky_top[3], sky_horizon[3]; // linear RGB, as all colours here
	float ground_colour[3];
	bool grid; // lines on the ground each metre, stronger each ten
	ob_vec3 sun; // direction towards the sun
} ob_look_def;

// A script of objects: its own file, or part of the scene.
typedef struct ob_script_def {
	char name[OB_NAME_MAX]; // for messages and lookup
	char *text; // Lua, ends with a 0; or an FMU (ob_fmu_model), its library behind it
	uint32_t size;
} ob_script_def;

// Number of the scene within limits: viewers may set it, and start the scene anew.
typedef struct ob_param_def {
	char name[OB_NAME_MAX], label[OB_NAME_MAX], unit[16];
	double value, min, max; // value: of this scene
	bool whole;
} ob_param_def;

enum { OB_CONTROL_VALUES = 4, OB_CONTROL_KEY = 16, OB_CONTROL_BUTTONS = 17 }; // BUTTONS: of a gamepad

// Control of viewers: a key, a button or a slider that sends a message to a script.
typedef struct ob_control_def {
	char key[OB_CONTROL_KEY]; // as browsers name it, lower case; "" = none
	uint32_t
		gamepad; // button of a gamepad, by its number in the Gamepad API's standard layout; OB_CONTROL_BUTTONS: none
	char label[OB_NAME_MAX];
	char sends[OB_NAME_MAX]; // first value of the message
	char to[OB_NAME_MAX]; // object; "" = the viewer's avatar
	double value
		[OB_CONTROL_VALUES]; // numbers behind it while it is held: the sum of all held ones that send the same
	uint32_t values; // 0: it is sent once, when pressed
	bool slider;
	double min, max; // of a slider, which begins at value[0]
} ob_control_def;

enum { OB_SCENE_MESHES_MAX = 255 }; // limit of passports
#define OB_SCENE_MESH_BYTES (64u << 20) // of all meshes

typedef struct ob_expected ob_expected;

typedef struct ob_scene {
	char *path; // as it was given, for messages
	char title[128];
	bool tour; // viewers are led through it (src/front/serve/page/tour.js)
	ob_run_settings run; // before the command line's settings (ob_run_settings_resolve)
	ob_settings asked; // those that the scene gives; run has those of lockstep
	double duration; // s
	uint64_t seed;
	uint32_t objects;
	ob_object_def *object; // [objects]; ids are their index
	uint32_t joints;
	ob_joint_passport *joint; // [joints]; their objects are there from the start
	uint32_t sensors;
	ob_sensor_passport *sensor; // [sensors]; rate 0: a sample in each step; kept: as readers want it
	uint32_t hulls;
	ob_hull *hull; // [hulls], by the number in passports
	ob_hull_corners *hull_corners; // [hulls], in the scene's frame
	ob_terrain_set *terrains; // by the number in passports; NULL: there are none
	uint32_t meshes;
	ob_mesh *mesh; // [meshes], by the number in passports, less 1; in the frame of the bodies
	uint32_t cameras;
	ob_camera_def *camera; // at least one
	ob_look_def look;
	uint32_t record_every; // steps between recorded states; default 1
	uint32_t scripts;
	ob_script_def *script; // [scripts]
	unsigned char *states; // initial states of all objects' scripts
	uint32_t states_bytes;
	uint32_t room; // objects that scripts may have created at the same time
	ob_object_def *avatar; // template: each viewer has an object of this kind while it is there; NULL: none
	uint32_t params, controls;
	ob_param_def *param; // [params]
	ob_control_def *control; // [controls]
	ob_expected *expected; // expectations for its run (scene/expect.h); NULL: there are none
	char *text; // text of its file: ob_scene_load_text makes the same scene from it
	size_t text_size;
} ob_scene;

// An object of a universe that runs, which a joint may hold.
typedef struct ob_joined {
	uint32_t id, generation;
	bool moved; // by forces
	ob_pose pose; // now
} ob_joined;

typedef struct ob_scene_options {
	const char *const *defines; // "name=value" of -D
	uint32_t define_count;
	bool has_seed;
	uint64_t seed; // replaces the scene's
	bool joining; // its objects are for a running universe: their meshes are named (look), not read
	// Finds an object of that by its name, for joints; with: of the caller's. false: there is none. NULL: no joints there.
	bool (*find)(void *with, const char *name, ob_joined *out);
	void *with;
} ob_scene_options;

// Reads, runs and checks a scene file; o may be NULL. NULL and e on error, in one line: "file:line: where.field:
// expected ..., got ..."; without a line if the file cannot be read or a -D does not fit. Any thread.
ob_scene *ob_scene_load(const char *path, const ob_scene_options *o, ob_error *e);
// The same for a text in memory; path is for its title and for messages.
ob_scene *ob_scene_load_text(const char *path, const char *text, size_t size, const ob_scene_options *o, ob_error *e);
void ob_scene_free(ob_scene *s);

// Thickness (m) of the thinnest object that moves; infinity: none does.
double ob_scene_thinnest(const ob_scene *s);

// Converts "#rrggbb" or "#rrggbbaa" to linear RGB and alpha; false: another format.
bool ob_scene_read_colour(const char *text, float linear[4]);
// Appends the value of a word, a number, true, false, or text, to the values of a message (scene/flat.h). false: no
// room.
bool ob_scene_put_value(const char *word, unsigned char *to, uint32_t *size, uint32_t room);

// Quantities of its object that an FMU can be connected with (ob_fmu_port.quantity); SI units, world frame.
typedef enum ob_fmu_quantity {
	OB_FMU_POSITION = 0, // and two more for y, z; so for the next
	OB_FMU_VELOCITY = 3,
	OB_FMU_SPIN = 6,
	OB_FMU_ATTITUDE = 9, // w, x, y, z
	OB_FMU_MASS = 13,
	OB_FMU_TIME,
	OB_FMU_FORCE = 15, // from here on outputs
	OB_FMU_TORQUE = 18,
	OB_FMU_QUANTITIES = 21
} ob_fmu_quantity;

enum { OB_SCENE_FMUS_MAX = 16 }; // different files of a scene
#define OB_SCENE_FMU_BYTES (16 << 20) // of one file

#define OB_SCENE_SCRIPT_BYTES (256 << 10) // of one script
#define OB_SCENE_ROOM_MAX 100000

#endif
