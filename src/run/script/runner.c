#include "script/runner.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/spelling.h"

static const char *const handler_names[OB_HANDLERS] = {
	[OB_HANDLER_START] = "on_start",     [OB_HANDLER_STEP] = "on_step",   [OB_HANDLER_CONTACT] = "on_contact",
	[OB_HANDLER_MESSAGE] = "on_message", [OB_HANDLER_BREAK] = "on_break", [OB_HANDLER_WAKE] = "on_wake",
	[OB_HANDLER_STOP] = "on_stop",
};

// ---- interpreters

static int open_all(lua_State *L)
{
	ob_library_open(L);
	return ob_script_calls_open(L);
}

// A function on_... that is no handler is one misspelt. Index 1: the globals.
static void find_misspelt(lua_State *L, ob_interpreter *p, const char *path)
{
	for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) {
		const char *name = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
		if (strncmp(name, "on", 2) != 0 || !lua_isfunction(L, -1) || lua_iscfunction(L, -1))
			continue;
		ob_spelling near = ob_spelling_start(name);
		for (int i = 0; i < OB_HANDLERS; i++)
			ob_spelling_offer(&near, handler_names[i]);
		if (!near.best || near.distance == 0 || near.distance > 2)
			continue;
		lua_Debug d;
		lua_pushvalue(L, -1);
		lua_getinfo(L, ">S", &d);
		if (!*p->warning.text || d.linedefined < p->misspelt_line) {
			p->misspelt_line = d.linedefined;
			ob_fail(&p->warning, "%s:%d: %.40s: no event calls a function of this name, did you mean %s?",
				path, d.linedefined, name, near.best);
		}
	}
}

// Called protected: takes the handlers out of the globals, and freezes the rest.
static int finish_text(lua_State *L)
{
	ob_interpreter *p = lua_touserdata(L, 1);
	lua_settop(L, 0);
	lua_pushglobaltable(L);
	for (int i = 0; i < OB_HANDLERS; i++) {
		lua_pushstring(L, handler_names[i]);
		const int type = lua_rawget(L, 1);
		if (type != LUA_TNIL && type != LUA_TFUNCTION)
			ob_sandbox_fail(L, "%s: expected a function, got a %s", handler_names[i], luaL_typename(L, -1));
		if (type == LUA_TFUNCTION)
			p->handler[i] = luaL_ref(L, LUA_REGISTRYINDEX);
		else
			lua_pop(L, 1);
	}
	find_misspelt(L, p, p->name);
	lua_pushliteral(L, "self");
	lua_rawget(L, 1);
	p->self = lua_touserdata(L, -1);
	ob_script_freeze(L, p);
	return 0;
}

static void close_interpreter(ob_interpreter *p)
{
	ob_sandbox_destroy(p->sandbox);
	free(p->watched);
	*p = (ob_interpreter){ .sandbox = NULL };
}

// The interpreter of a text; if the text cannot run, its `broken` explains why.
static ob_interpreter *interpreter_of(ob_script_runner *r, uint32_t script)
{
	static const ob_sandbox_limits limits = {
		.memory = OB_SCRIPT_MEMORY,
		.string = OB_SCRIPT_STRING,
		.instructions = OB_SCRIPT_INSTRUCTIONS,
		.seconds = INFINITY, // all machines stop at the same place
		.out_of_memory = "the script needs more than 4 MiB of memory",
		.out_of_string = "a string grew beyond 64 KiB",
		.out_of_instructions = "stopped after a million instructions: does a loop never end?",
	};
	_Static_assert(OB_SCRIPT_MEMORY == 4 << 20 && OB_SCRIPT_STRING == 64 << 10 && OB_SCRIPT_INSTRUCTIONS == 1000000,
		       "said above");
	const ob_script_directory *d = r->data->script_text;
	ob_interpreter *p = &r->interpreter[script];
	if (p->sandbox || *p->broken.text)
		return p;
	for (int i = 0; i < OB_HANDLERS; i++)
		p->handler[i] = LUA_NOREF;
	p->name = d->text[script].name;
	p->sandbox = ob_sandbox_create_limited(d->text[script].name, &limits, open_all, r, &p->broken);
	if (!p->sandbox)
		return p;
	lua_State *L = ob_sandbox_lua(p->sandbox);
	r->turn = NULL;
	ob_random_seed(&r->builder.random, 1);
	bool good =
		ob_sandbox_run(p->sandbox, (const char *)d + d->text[script].offset, d->text[script].size, &p->broken);
	if (good) {
		lua_pushcfunction(L, finish_text);
		lua_pushlightuserdata(L, p);
		good = ob_sandbox_call(p->sandbox, 1, &p->broken);
	}
	const ob_error why = p->broken;
	if (!good) {
		close_interpreter(p);
		p->broken = why;
	}
	return p;
}

// ---- calls

// Calls what lies below so many arguments at the top of the stack.
static bool call_counted(ob_script_runner *r, ob_interpreter *p, int arguments, ob_error *e)
{
	const bool fine = ob_sandbox_call(p->sandbox, arguments, e);
	r->instructions += ob_sandbox_instructions(p->sandbox);
	return fine;
}

// Calls the handler, if the script has it, with the arguments at the top of the stack.
static bool call(ob_script_runner *r, ob_interpreter *p, ob_handler h, int arguments, ob_error *e)
{
	lua_State *L = ob_sandbox_lua(p->sandbox);
	if (r->ended || p->handler[h] == LUA_NOREF) {
		lua_pop(L, arguments);
		return true;
	}
	lua_rawgeti(L, LUA_REGISTRYINDEX, p->handler[h]);
	lua_insert(L, -1 - arguments);
	return call_counted(r, p, arguments, e);
}

// Called protected, for memory may run out: the arguments of a message, and the call.
typedef struct delivery {
	ob_script_runner *r;
	ob_interpreter *p;
	const ob_script_post *post;
	const ob_script_touch *touch;
	uint32_t joint;
} delivery;

static void push_object(lua_State *L, uint32_t id, uint32_t generation)
{
	ob_flat_object *o = lua_newuserdatauv(L, sizeof *o, 0);
	*o = (ob_flat_object){ id, generation };
	luaL_setmetatable(L, OB_FLAT_OBJECT);
}

static int tell_message(lua_State *L)
{
	const delivery *d = lua_touserdata(L, 1);
	const unsigned char *values = (const unsigned char *)(d->post + 1);
	lua_settop(L, 0);
	lua_rawgeti(L, LUA_REGISTRYINDEX, d->p->handler[OB_HANDLER_MESSAGE]);
	push_object(L, d->post->object, d->post->generation);
	int arguments = 1;
	for (uint32_t at = 0, n; at < d->post->used; at += n, arguments++) {
		luaL_checkstack(L, 4, "too many values");
		n = ob_flat_push(L, values + at, d->post->used - at);
		if (!n)
			break;
	}
	lua_call(L, arguments, 0);
	return 0;
}

static int tell_touch(lua_State *L)
{
	const delivery *d = lua_touserdata(L, 1);
	const ob_vec3 at = d->touch->point;
	lua_settop(L, 0);
	lua_rawgeti(L, LUA_REGISTRYINDEX, d->p->handler[OB_HANDLER_CONTACT]);
	push_object(L, d->touch->other, d->touch->generation);
	lua_pushnumber(L, d->touch->impulse);
	lua_createtable(L, 3, 0);
	const double x[] = { at.x, at.y, at.z };
	for (int i = 0; i < 3; i++) {
		lua_pushnumber(L, x[i]);
		lua_rawseti(L, -2, i + 1);
	}
	lua_call(L, 3, 0);
	return 0;
}

// Name of the joint, force and torque by which it broke.
static int tell_break(lua_State *L)
{
	const delivery *d = lua_touserdata(L, 1);
	const ob_joint_passport *j = &d->r->data->joint[d->joint];
	const ob_joint_load load = ob_joint_load_now(d->r->u, d->joint);
	lua_settop(L, 0);
	lua_rawgeti(L, LUA_REGISTRYINDEX, d->p->handler[OB_HANDLER_BREAK]);
	lua_pushlstring(L, j->name, strnlen(j->name, sizeof j->name));
	lua_pushnumber(L, ob_norm(load.force));
	lua_pushnumber(L, ob_norm(load.torque));
	lua_call(L, 3, 0);
	return 0;
}

static bool call_with(lua_CFunction f, delivery *d, ob_error *e)
{
	lua_State *L = ob_sandbox_lua(d->p->sandbox);
	lua_pushcfunction(L, f);
	lua_pushlightuserdata(L, d);
	return call_counted(d->r, d->p, 1, e);
}

static bool tell_mail(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	const ob_script_cell *c = r->cell;
	bool good = true;
	for (uint32_t at = 0; good && !r->ended && at + sizeof(ob_script_post) <= c->inbox_bytes;) {
		const ob_script_post *post = (const ob_script_post *)(const void *)(c->inbox + at);
		at += (uint32_t)sizeof *post + post->bytes;
		if (post->used > post->bytes || at > OB_SCRIPT_INBOX_BYTES) // not the data that was sent
			break;
		if (p->handler[OB_HANDLER_MESSAGE] != LUA_NOREF)
			good = call_with(tell_message, &(delivery){ r, p, post, NULL, 0 }, e);
	}
	return good;
}

static bool tell_touches(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	bool good = true;
	for (uint32_t i = 0; good && !r->ended && i < r->cell->touches && i < OB_SCRIPT_TOUCHES; i++)
		if (p->handler[OB_HANDLER_CONTACT] != LUA_NOREF)
			good = call_with(tell_touch, &(delivery){ r, p, NULL, &r->cell->touch[i], 0 }, e);
	return good;
}

static bool tell_breaks(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	const uint32_t id = r->turn->object;
	bool good = true;
	if (p->handler[OB_HANDLER_BREAK] == LUA_NOREF)
		return true;
	for (uint32_t j = ob_joint_first(r->data, id); j && good && !r->ended; j = ob_joint_next(r->data, j, id))
		if (ob_joint_broke_now(r->u, j - 1))
			good = call_with(tell_break, &(delivery){ r, p, NULL, NULL, j - 1 }, e);
	return good;
}

static bool tell_step(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	if (p->handler[OB_HANDLER_STEP] == LUA_NOREF)
		return true;
	lua_pushnumber(ob_sandbox_lua(p->sandbox), r->settings->step_length);
	return call(r, p, OB_HANDLER_STEP, 1, e);
}

static int check_frozen(lua_State *L)
{
	ob_script_check_frozen(L, lua_touserdata(L, 1));
	return 0;
}

static bool is_still_frozen(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	lua_State *L = ob_sandbox_lua(p->sandbox);
	if (!p->watched_count)
		return true;
	lua_pushcfunction(L, check_frozen);
	lua_pushlightuserdata(L, p);
	return call_counted(r, p, 1, e);
}

// Makes all due calls, in this order.
static bool call_all(ob_script_runner *r, ob_interpreter *p, ob_error *e)
{
	ob_script_turn *t = r->turn;
	const uint32_t flags = t->flags, wake = t->wake;
	t->flags = (flags | OB_SCRIPT_STARTED) & ~(uint32_t)(OB_SCRIPT_MAIL | OB_SCRIPT_TOUCHED | OB_SCRIPT_BROKE);
	if (p->handler[OB_HANDLER_STEP] != LUA_NOREF)
		t->flags |= OB_SCRIPT_EACH_STEP;
	if (p->handler[OB_HANDLER_CONTACT] != LUA_NOREF)
		t->flags |= OB_SCRIPT_FEELS;
	if (!(flags & OB_SCRIPT_STARTED) && !call(r, p, OB_HANDLER_START, 0, e))
		return false;
	if (flags & OB_SCRIPT_MAIL && !tell_mail(r, p, e))
		return false;
	if (flags & OB_SCRIPT_TOUCHED && !tell_touches(r, p, e))
		return false;
	if (flags & OB_SCRIPT_BROKE && !tell_breaks(r, p, e))
		return false;
	if (wake <= r->step && flags & OB_SCRIPT_STARTED) {
		if (t->wake == wake) // and no other wake-up was requested meanwhile
			t->wake = UINT32_MAX;
		if (!call(r, p, OB_HANDLER_WAKE, 0, e))
			return false;
	}
	if (!tell_step(r, p, e))
		return false;
	if (r->ended || flags & OB_SCRIPT_LEAVING) {
		r->ended = false;
		if (!call(r, p, OB_HANDLER_STOP, 0, e))
			return false;
		ob_script_leave(r);
	}
	return is_still_frozen(r, p, e);
}

static bool attempt(ob_script_runner *r, const ob_script_turn *turn, ob_error *e)
{
	ob_interpreter *p = interpreter_of(r, turn->script - 1);
	if (*p->broken.text) {
		*e = p->broken;
		return false;
	}
	ob_script_clear_requests(r, turn);
	*p->self = (ob_flat_object){ turn->object, turn->generation };
	r->ended = false;
	r->warning = p->warning;
	return call_all(r, p, e);
}

// Tells once of each object what its script does in vain.
static void pass_on_warning(const ob_script_runner *r, ob_script_turn *t, ob_script_cell *c)
{
	if (!*r->warning.text || t->flags & OB_SCRIPT_WARNED)
		return;
	t->flags |= OB_SCRIPT_WARNED;
	c->asks |= OB_SCRIPT_ASKS_ERROR;
	c->failed_step = (uint32_t)r->step;
	snprintf(c->error, sizeof c->error, "%.*s", OB_SCRIPT_ERROR_BYTES - 1, r->warning.text);
}

static uint64_t run_text(ob_script_runner *r, ob_script_turn *t, ob_script_cell *c)
{
	const ob_script_turn before = *t;
	unsigned char state[OB_SCRIPT_STATE_BYTES];
	const uint32_t state_bytes = c->state_bytes;
	ob_error e = { "" };
	memcpy(state, c->state, state_bytes);
	r->cell = c;
	r->step = ob_step_count(r->u);
	for (int again = 0;; again++) {
		ob_interpreter *p = interpreter_of(r, before.script - 1);
		r->instructions = 0; // the cost of an attempt without memory depends on the worker
		r->turn = t;
		r->state = (ob_flat){ c->state, state_bytes, OB_SCRIPT_STATE_BYTES };
		memcpy(r->builder.random.s, c->random, sizeof c->random);
		if (attempt(r, &before, &e)) {
			pass_on_warning(r, t, c);
			ob_sandbox_forbid_collection(p->sandbox); // from now on it holds garbage of others
			break;
		}
		// An interpreter that has run others may have less memory left than a new one, which decides.
		const bool memory = p->sandbox && ob_sandbox_lacked_memory(p->sandbox);
		if (!*p->broken.text)
			close_interpreter(p);
		*t = before;
		memcpy(c->state, state, state_bytes);
		if (memory && again == 0)
			continue;
		ob_script_stop_turn(r, t, &e);
		r->state.size = state_bytes;
		break;
	}
	c->state_bytes = r->state.size;
	memcpy(c->random, r->builder.random.s, sizeof c->random);
	c->inbox_bytes = c->touches = 0;
	r->turn = NULL;
	return r->instructions;
}

uint64_t ob_script_runner_run(void *runner, ob_script_turn *const *t, ob_script_cell *const *c, uint32_t n)
{
	enum { STEP_INSTRUCTIONS = 1000 }; // a step of an FMU counts as so many; it cannot be measured in them
	ob_script_runner *r = runner;
	if (t[0]->script > r->data->script_text->scripts)
		return 0;
	for (uint32_t i = 0; i < n; i++)
		if (c[i]->state_bytes > OB_SCRIPT_STATE_BYTES)
			return 0;
	if (!ob_script_is_foreign(r->data->script_text, t[0]->script))
		return run_text(r, t[0], c[0]);
	ob_script_run_foreign(r, t, c, n);
	return STEP_INSTRUCTIONS;
}

// ---- runners

ob_script_runner *ob_script_runner_create(ob_universe *u, uint32_t worker)
{
	const ob_step_data *data = ob_universe_step_data(u);
	ob_script_runner *r = calloc(1, sizeof *r);
	ob_script_def *names = r ? calloc(OB_SCRIPTS_MAX, sizeof *names) : NULL;
	if (!names) {
		free(r);
		return NULL;
	}
	r->u = u;
	r->worker = worker;
	r->data = data;
	r->settings = ob_universe_settings(u);
	r->builder.scene = &r->scene;
	r->joining = (ob_scene_options){ .joining = true, .find = ob_script_find_joined, .with = r };
	r->builder.options = &r->joining;
	r->scene.script = names;
	const uint32_t scripts = data->script_text->scripts;
	r->scene.scripts = scripts < OB_SCRIPTS_MAX ? scripts : OB_SCRIPTS_MAX;
	for (uint32_t i = 0; i < r->scene.scripts; i++)
		if (!ob_script_is_foreign(data->script_text, i + 1))
			memcpy(names[i].name, data->script_text->text[i].name, sizeof names[i].name);
	ob_script_open_foreign(r);
	return r;
}

void ob_script_runner_destroy(ob_script_runner *r)
{
	if (!r)
		return;
	for (uint32_t i = 0; i < OB_SCRIPTS_MAX; i++)
		close_interpreter(&r->interpreter[i]);
	free(r->scene.script);
	free(r->scene.object);
	free(r->scene.joint);
	free(r->scene.hull);
	free(r->scene.hull_corners);
	free(r->builder.hull_points);
	free(r->scene.states);
	free(r);
}
