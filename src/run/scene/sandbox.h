// The sandbox: a Lua 5.4 state that can only compute and call the functions that it is given.
//
// No files, no system, no loading of code, no metatables, no coroutines, no protected calls. Bounded in memory,
// in instructions and in time. Work that is done inside one instruction counts as instructions: calls of Lua's library
// by their arguments, before they do it (library.c), strings by their bytes (sandbox.c).
// The same scene gives the same run on any machine: pairs() has a fixed order (library.c), random numbers a seed.
//
// Every error is one line, "path:line: text". A sandbox belongs to one thread; several may exist at once.
#ifndef OB_SCENE_SANDBOX_H
#define OB_SCENE_SANDBOX_H

#include <stdbool.h>
#include <stddef.h>

#include <lua.h>
#include <ob/error.h>

#include "base/budget.h"

#define OB_SANDBOX_MEMORY ((size_t)64 << 20) // bytes, all that Lua holds
#define OB_SANDBOX_STRING ((size_t)1 << 20) // bytes, one string
#define OB_SANDBOX_INSTRUCTIONS 50000000 // instructions of the Lua machine

typedef struct ob_sandbox ob_sandbox;

// Limits: of all that a sandbox runs, and with ob_sandbox_call by one call.
typedef struct ob_sandbox_limits {
	size_t memory; // bytes
	size_t string; // bytes, one string
	uint64_t instructions;
	double seconds; // CPU of its thread; INFINITY: the same on any machine
	const char *out_of_memory, *out_of_string, *out_of_instructions; // texts of the errors
} ob_sandbox_limits;

// path: for messages; open: builds the globals (ob_library_open); user: the result of ob_sandbox_user in functions
// called from Lua. Path and user are kept, not copied. NULL and e when there is no memory.
ob_sandbox *ob_sandbox_create(const char *path, lua_CFunction open, void *user, ob_error *e);
// The same with limits of its own.
ob_sandbox *ob_sandbox_create_limited(const char *path, const ob_sandbox_limits *limits, lua_CFunction open, void *user,
				      ob_error *e);
void ob_sandbox_destroy(ob_sandbox *s); // NULL is allowed
// Takes the user away: calls that need it are errors of the text from now on.
void ob_sandbox_release_user(ob_sandbox *s);

// Offers f to the scene as a global (library = NULL) or as a field of a library ("math").
bool ob_sandbox_offer(ob_sandbox *s, const char *library, const char *name, lua_CFunction f, ob_error *e);
// Runs Lua text (not bytecode); false and e when it fails.
bool ob_sandbox_run(ob_sandbox *s, const char *text, size_t size, ob_error *e);

// The Lua state, for callers of functions of the text that has run. ob_sandbox_call: the function and its arguments are
// at the top of the stack, which is empty afterwards; false and e when it fails. lacked_memory: true if the last run or
// call failed for lack of memory.
lua_State *ob_sandbox_lua(ob_sandbox *s);
bool ob_sandbox_call(ob_sandbox *s, int arguments, ob_error *e);
bool ob_sandbox_lacked_memory(const ob_sandbox *s);
// Limits each of the next calls.
void ob_sandbox_limit_instructions(ob_sandbox *s, uint64_t instructions);
// The next calls may not collect garbage for want of memory: it then runs out, where a new sandbox might go on.
void ob_sandbox_forbid_collection(ob_sandbox *s);
// Instructions of the last call, as far as it came.
uint64_t ob_sandbox_instructions(const ob_sandbox *s);

// For functions called from Lua:
void *ob_sandbox_user(lua_State *L);
// The line of the scene that is running; 0: none.
int ob_sandbox_line(lua_State *L);
// Raises "path:line: ..." ; never returns.
_Noreturn void ob_sandbox_fail(lua_State *L, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Raises the limit of instructions by so many, for useful work.
void ob_sandbox_extend(lua_State *L, unsigned instructions);
// Counts work done outside the Lua machine, in instructions; raises an error at a limit. One for each 20 ns or so.
void ob_sandbox_spend(lua_State *L, unsigned instructions);
// Counts a walk through the largest table that there may be: one that was emptied has its size still.
void ob_sandbox_spend_search(lua_State *L);
size_t ob_sandbox_string_max(lua_State *L); // bytes
const char *ob_sandbox_out_of_string(lua_State *L); // error text for a longer one

// lua_CFunction, no arguments: builds the globals of a fresh state, the harmless part of Lua's libraries (library.c).
int ob_library_open(lua_State *L);

#endif
