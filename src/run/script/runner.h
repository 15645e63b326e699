// Shared by the files of this module: a runner, and its current call.
#ifndef OB_SCRIPT_RUNNER_H
#define OB_SCRIPT_RUNNER_H

#include <ob/motion.h>

#include "scene/builder.h"
#include "scene/flat.h"
#include "scene/sandbox.h"
#include "script/script.h"
#include "table/desk.h"

typedef enum ob_handler {
	OB_HANDLER_START,
	OB_HANDLER_STEP,
	OB_HANDLER_CONTACT,
	OB_HANDLER_MESSAGE,
	OB_HANDLER_BREAK,
	OB_HANDLER_WAKE,
	OB_HANDLER_STOP,
	OB_HANDLERS
} ob_handler;

// A local variable outside of functions in a text, which must not change: an upvalue of a function, by its number.
typedef struct ob_watched {
	int function, upvalue, value; // function, value: references in the registry
} ob_watched;

typedef struct ob_interpreter {
	ob_sandbox *sandbox; // NULL: not created yet
	int handler[OB_HANDLERS]; // references; LUA_NOREF: the script has none
	ob_flat_object *self; // the script's self
	ob_watched *watched;
	uint32_t watched_count, watched_room;
	const char *name; // of its text
	int misspelt_line;
	ob_error warning; // the first statement without effect in the text; empty: none was found
	ob_error broken; // why the text itself cannot run; empty: it can
} ob_interpreter;

// An FMU among the texts.
typedef struct ob_foreign {
	ob_fmu_model model;
	ob_desk desk;
	bool spoilt; // the process there has failed in a turn
} ob_foreign;

struct ob_script_runner {
	ob_builder builder; // first: the functions that scripts share with scenes find it in the runner's place
	ob_scene_options joining; // the builder's
	ob_scene scene; // for objects that a script creates
	ob_universe *u;
	uint32_t worker;
	const ob_step_data *data;
	const ob_run_settings *settings;
	ob_interpreter interpreter[OB_SCRIPTS_MAX];
	ob_foreign foreign[OB_SCRIPTS_MAX];
	// Data of the running call; turn NULL: a text is being read.
	ob_script_turn *turn;
	ob_script_cell *cell;
	ob_flat state; // the cell's
	uint64_t step;
	uint64_t instructions; // by all calls of this turn
	ob_error warning; // the first call without effect
	bool ended; // it has requested its own removal
};

// Begins a turn without any request; stops a script for good; removes its object: the host does, at once.
void ob_script_clear_requests(ob_script_runner *r, const ob_script_turn *turn);
void ob_script_begin_turn(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c);
void ob_script_stop_turn(ob_script_runner *r, ob_script_turn *t, const ob_error *why);
void ob_script_leave(ob_script_runner *r);

// Prepares the FMUs among the texts; runs turns of objects that have one of them.
void ob_script_open_foreign(ob_script_runner *r);
void ob_script_run_foreign(ob_script_runner *r, ob_script_turn *const *t, ob_script_cell *const *c, uint32_t n);

// Notes, as "name:line: text", a call without effect; the first is kept.
void ob_script_warn(lua_State *L, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Finds an object of the universe, as it is now, for a joint (ob_scene_options.find).
bool ob_script_find_joined(void *runner, const char *name, ob_joined *to);
// Adds all functions for scripts to a sandbox: globals, and methods of objects. A lua_CFunction without arguments,
// after ob_library_open. Pushes nothing; sets self.
int ob_script_calls_open(lua_State *L);
// Freezes all values that a text has left behind: its globals, the tables reachable from it, and its outer locals,
// which are noted.
void ob_script_freeze(lua_State *L, ob_interpreter *p);
// Raises an error if an outer local has changed.
void ob_script_check_frozen(lua_State *L, const ob_interpreter *p);
// Replaces the table at this index, which may be frozen, by a plain copy.
void ob_script_thaw(lua_State *L, int index);

// Returns a list of the newest values of a sensor, by its name, and their time (s); nothing if there are none.
int ob_script_call_sense(lua_State *L);

// The first hit of a ray with another object within its length: from a point, in a unit direction.
typedef struct ob_ray_hit {
	uint32_t id;
	double distance; // m
	ob_vec3 normal; // unit, out of the object
} ob_ray_hit;
// Spends instructions for the objects that it looks at, as it goes.
bool ob_ray_cast(lua_State *L, const ob_universe *u, ob_vec3 from, ob_vec3 direction, double length, uint32_t but,
		 ob_ray_hit *hit);

#endif
