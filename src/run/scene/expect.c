#include "scene/expect.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>

#include "base/number.h"
#include "base/spelling.h"
#include "motion/joint_value.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"
#include "scene/vector.h"
#include "scene_texts.h" // generated: scene_lab_lua, of lab.lua

// ---- declarations

static ob_expected *expected_of(lua_State *L, ob_builder *b, const char *where)
{
	if (b->options->joining)
		ob_sandbox_fail(L, "%s: expected in a scene, not in what is added to a run", where);
	if (!b->scene->expected) {
		b->scene->expected = calloc(1, sizeof *b->scene->expected);
		if (!b->scene->expected)
			ob_sandbox_fail(L, "%s: no memory left on this machine", where);
		b->scene->expected->of.runs = 1;
	}
	return b->scene->expected;
}

// Keeps the function at the top of the stack, which is popped.
static int keep_function(lua_State *L, const char *where)
{
	if (!lua_isfunction(L, -1)) {
		char got[OB_TEXT_VALUE];
		ob_text_of_value(L, -1, got);
		ob_sandbox_fail(L, "%s: expected a function(run), got %s", where, got);
	}
	return luaL_ref(L, LUA_REGISTRYINDEX);
}

typedef struct expectation {
	const char *unit, *source;
	double below;
	bool worst, mean;
} expectation;

#define F(type, member, ...) OB_FIELD(type, member, .name = #member, __VA_ARGS__)
#define TEXT(type, member, to) F(type, member, .kind = OB_FIELD_TEXT, .high = sizeof((to *)0)->member - 1)
static const ob_field expectation_fields[] = {
	TEXT(expectation, unit, ob_expectation),
	TEXT(expectation, source, ob_expectation),
	F(expectation, below, .kind = OB_FIELD_NUMBER, .low = 0, .high = INFINITY),
	F(expectation, worst, .kind = OB_FIELD_BOOLEAN),
	F(expectation, mean, .kind = OB_FIELD_BOOLEAN),
};

// expect { "name", below = .01, unit = "m", source = "Newton 1687", function(run) return ... end }
int ob_scene_call_expect(lua_State *L)
{
	ob_expected *x = expected_of(L, ob_sandbox_user(L), "expect");
	expectation d = { "1", "", NAN, false, false };
	if (!lua_istable(L, 1) || lua_rawgeti(L, 1, 1) != LUA_TSTRING)
		ob_sandbox_fail(
			L,
			"expect: expected a name first, as in expect { \"way\", below = .01, function(run) ... end }");
	if (x->count == OB_EXPECTATIONS_MAX)
		ob_sandbox_fail(L, "expect: expected at most %d in a scene", OB_EXPECTATIONS_MAX);
	ob_expectation *to = &x->expectation[x->count];
	size_t size;
	const char *name = lua_tolstring(L, -1, &size);
	if (size == 0 || size >= sizeof to->name || !ob_text_is_clean(name, size))
		ob_sandbox_fail(L, "expect: expected a name of 1 to %zu bytes", sizeof to->name - 1);
	lua_settop(L, 1);
	lua_newtable(L); // the fields alone
	for (lua_pushnil(L); lua_next(L, 1);) {
		lua_pushvalue(L, -2);
		lua_insert(L, -2);
		if (lua_isinteger(L, -2) && (lua_tointeger(L, -2) == 1 || lua_tointeger(L, -2) == 2))
			lua_pop(L, 2);
		else
			lua_rawset(L, 2);
	}
	ob_fields_read(L, 2, "expect", expectation_fields, sizeof expectation_fields / sizeof *expectation_fields, &d);
	*to = (ob_expectation){ .limit = d.below, .worst = d.worst, .mean = d.mean, .line = ob_sandbox_line(L) };
	snprintf(to->name, sizeof to->name, "%s", name);
	snprintf(to->unit, sizeof to->unit, "%s", d.unit);
	snprintf(to->source, sizeof to->source, "%s", d.source);
	lua_rawgeti(L, 1, 2);
	to->function = keep_function(L, "expect");
	x->count++;
	return 0;
}

// watch(function(run) ... end)
int ob_scene_call_watch(lua_State *L)
{
	ob_expected *x = expected_of(L, ob_sandbox_user(L), "watch");
	if (x->watches == OB_EXPECTATIONS_MAX)
		ob_sandbox_fail(L, "watch: expected at most %d in a scene", OB_EXPECTATIONS_MAX);
	lua_settop(L, 1);
	x->watch_line[x->watches] = ob_sandbox_line(L);
	x->watch[x->watches] = keep_function(L, "watch");
	x->watches++;
	return 0;
}

typedef struct case_fields {
	const char *name, *setup, *others;
	uint32_t row, runs;
	bool slow, compared, sleeps, variants;
} case_fields;

static const ob_field fields_of_case[] = {
	F(case_fields, variants, .kind = OB_FIELD_TABLE), // first: variants have none themselves
	TEXT(case_fields, name, ob_case_def),
	TEXT(case_fields, setup, ob_case_def),
	TEXT(case_fields, others, ob_case_def),
	F(case_fields, row, .kind = OB_FIELD_COUNT, .low = 1, .high = 1e6),
	F(case_fields, runs, .kind = OB_FIELD_COUNT, .low = 1, .high = OB_CASE_RUNS_MAX),
	F(case_fields, slow, .kind = OB_FIELD_BOOLEAN),
	F(case_fields, compared, .kind = OB_FIELD_BOOLEAN),
	F(case_fields, sleeps, .kind = OB_FIELD_BOOLEAN),
};
enum { CASE_FIELDS = sizeof fields_of_case / sizeof *fields_of_case };
#undef F
#undef TEXT

// Notes the names of all variants in the list at index 2, and pushes the one that -D variant=NAME chooses, or the first.
static void choose_variant(lua_State *L, ob_builder *b, ob_case_def *c)
{
	const char *wanted = ob_builder_defined(L, b, "variant");
	const size_t n = lua_rawlen(L, 2);
	size_t chosen = wanted ? 0 : 1;
	if (n < 1 || n > OB_CASE_VARIANTS_MAX)
		ob_sandbox_fail(L, "case.variants: expected a list of 1 to %d tables with names", OB_CASE_VARIANTS_MAX);
	for (size_t i = 1; i <= n; i++) {
		const char *name =
			lua_rawgeti(L, 2, (lua_Integer)i) == LUA_TTABLE && lua_getfield(L, -1, "name") == LUA_TSTRING
				? lua_tostring(L, -1)
				: "";
		if (!*name || strlen(name) >= OB_CASE_NAME)
			ob_sandbox_fail(L, "case.variants[%zu]: expected a table with a name of 1 to %d bytes", i,
					OB_CASE_NAME - 1);
		snprintf(c->variant[c->variants++], OB_CASE_NAME, "%s", name);
		chosen = wanted && strcmp(wanted, name) == 0 ? i : chosen;
		lua_settop(L, 2);
	}
	if (!chosen)
		ob_sandbox_fail(L, "case.variants: there is none of -D variant=%.40s", wanted);
	lua_rawgeti(L, 2, (lua_Integer)chosen);
}

// Number of the run from -D run=N; 0 without.
static uint32_t number_of_run(lua_State *L, ob_builder *b, uint32_t runs)
{
	const char *text = ob_builder_defined(L, b, "run");
	char *end;
	const unsigned long run = text ? strtoul(text, &end, 10) : 0;
	if (text && (!*text || *end || run >= runs))
		ob_sandbox_fail(L, "case.runs: expected -D run= with a whole number from 0 to %u, got %.40s", runs - 1,
				text);
	return (uint32_t)run;
}

// The name of the file, without folder and ending.
static const char *name_of_file(lua_State *L, const char *path)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	lua_pushlstring(L, name, strcspn(name, "."));
	return lua_tostring(L, -1);
}

// case { runs = 3, setup = "...", variants = { { name = "a", ... }, ... } }: returns a table with the number of the run, and
// all fields of the variant.
int ob_scene_call_case(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	ob_case_def *c = &expected_of(L, b, "case")->of;
	case_fields d = { .setup = "", .others = "", .runs = 1 };
	lua_settop(L, 1);
	if (*c->name)
		ob_sandbox_fail(L, "case: expected at most one call");
	ob_fields_read(L, 1, "case", fields_of_case, CASE_FIELDS, &d);
	lua_newtable(L); // the result
	if (d.variants) {
		lua_getfield(L, 1, "variants");
		lua_replace(L, 2);
		choose_variant(L, b, c);
		lua_newtable(L);
		lua_newtable(L); // 5: the variant's fields that are those of a case
		for (lua_pushnil(L); lua_next(L, 3);) {
			const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
			for (int i = 1; i < CASE_FIELDS; i++) {
				if (strcmp(fields_of_case[i].name, key) != 0)
					continue;
				lua_pushvalue(L, -1);
				lua_setfield(L, 5, key);
			}
			lua_pushvalue(L, -2);
			lua_insert(L, -2);
			lua_rawset(L, 4);
		}
		ob_fields_read(L, 5, "case.variants", fields_of_case, CASE_FIELDS, &d);
		lua_settop(L, 4);
	}
	if (!d.name)
		d.name = name_of_file(L, b->path);
	snprintf(c->name, sizeof c->name, "%s", d.name);
	snprintf(c->setup, sizeof c->setup, "%s", d.setup);
	snprintf(c->others, sizeof c->others, "%s", d.others);
	c->row = d.row, c->runs = d.runs, c->slow = d.slow, c->compared = d.compared, c->sleeps = d.sleeps;
	c->run = number_of_run(L, b, c->runs);
	lua_settop(L, d.variants ? 4 : 2);
	lua_pushinteger(L, c->run);
	lua_setfield(L, -2, "run");
	return 1;
}

// ---- the library of the lab

// Upvalue 1: true when the library is there.
static int library_index(lua_State *L)
{
	if (!lua_toboolean(L, lua_upvalueindex(1))) {
		if (luaL_loadbufferx(L, scene_lab_lua, sizeof scene_lab_lua - 1, "=lab", "t") != LUA_OK)
			lua_error(L);
		lua_call(L, 0, 1);
		for (lua_pushnil(L); lua_next(L, 3);) {
			lua_pushvalue(L, -2);
			lua_insert(L, -2);
			lua_rawset(L, 1);
		}
		lua_settop(L, 2);
		lua_pushboolean(L, true);
		lua_replace(L, lua_upvalueindex(1));
	}
	lua_pushvalue(L, 2);
	if (lua_rawget(L, 1) == LUA_TNIL)
		ob_sandbox_fail(L, "lab: it has no \"%.40s\"",
				lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?");
	return 1;
}

void ob_expected_open(lua_State *L)
{
	lua_newtable(L);
	lua_newtable(L);
	lua_pushboolean(L, false);
	lua_pushcclosure(L, library_index, 1);
	lua_setfield(L, -2, "__index");
	lua_setmetatable(L, -2);
	lua_setfield(L, -2, "lab");
}

// ---- the view of a run

static const char run_kind[] = "run", body_kind[] = "body";

typedef struct body {
	ob_expected *of;
	uint32_t id;
	bool start; // as it was
} body;

static ob_expected *run_at(lua_State *L)
{
	ob_expected **x = luaL_testudata(L, 1, run_kind);
	if (!x || !(*x)->now)
		ob_sandbox_fail(L,
				"run: expected the run that a function of expect or watch gets, while that is called");
	ob_sandbox_spend(L, 8);
	return *x;
}

static uint32_t find_object(lua_State *L, const ob_expected *x, int index)
{
	static const char names[] = "expect.names";
	if (lua_type(L, index) != LUA_TSTRING)
		ob_sandbox_fail(L, "run: expected the name of an object, as in run[\"ball\"], got a %s",
				luaL_typename(L, index));
	if (lua_getfield(L, LUA_REGISTRYINDEX, names) != LUA_TTABLE) {
		lua_newtable(L);
		for (uint32_t i = 0; i < x->scene->objects; i++) {
			lua_pushinteger(L, i);
			lua_setfield(L, -2, x->scene->object[i].passport.name);
		}
		lua_pushvalue(L, -1);
		lua_setfield(L, LUA_REGISTRYINDEX, names);
		lua_replace(L, -2);
	}
	lua_pushvalue(L, index);
	if (lua_rawget(L, -2) == LUA_TNUMBER) {
		const uint32_t id = (uint32_t)lua_tointeger(L, -1);
		lua_pop(L, 2);
		return id;
	}
	const char *name = lua_tostring(L, index);
	ob_spelling spelling = ob_spelling_start(name);
	for (uint32_t i = 0; i < x->scene->objects; i++)
		ob_spelling_offer(&spelling, x->scene->object[i].passport.name);
	if (spelling.best)
		ob_sandbox_fail(L, "run: no object \"%.47s\", did you mean \"%s\"?", name, spelling.best);
	ob_sandbox_fail(L, "run: no object \"%.47s\": expected the name that an object of the scene has", name);
}

static void push_body(lua_State *L, ob_expected *x, uint32_t id, bool start)
{
	*(body *)lua_newuserdatauv(L, sizeof(body), 0) = (body){ x, id, start };
	luaL_setmetatable(L, body_kind);
}

static bool is_there(const ob_expected *x, uint32_t id)
{
	return id < x->now->count && x->now->passport[id].flags & OB_OBJECT_PRESENT;
}

static bool moves(const ob_passport *p)
{
	return !(p->flags & OB_OBJECT_PRESCRIBED);
}

// A list of the objects that forces move.
static void push_bodies(lua_State *L, ob_expected *x)
{
	lua_Integer n = 0;
	lua_newtable(L);
	for (uint32_t id = 0; id < x->scene->objects && id < x->now->count; id++) {
		if (!is_there(x, id) || !moves(&x->now->passport[id]))
			continue;
		push_body(L, x, id, false);
		lua_rawseti(L, -2, ++n);
		ob_sandbox_spend(L, 4);
	}
}

enum { MEASURED = 64 }; // instructions that an object counts as in a measure

// run:penetration(): the deepest and the mean, m; with two names, between the objects from the first to the second alone.
static int penetration(lua_State *L)
{
	const ob_expected *x = run_at(L);
	const ob_snapshot *now = x->now;
	ob_snapshot part = *now;
	ob_penetration p;
	if (!lua_isnoneornil(L, 2)) {
		const uint32_t first = find_object(L, x, 2), last = find_object(L, x, 3);
		if (last < first || last >= now->count)
			ob_sandbox_fail(L,
					"run:penetration: expected two objects in the order in which they were built");
		part = (ob_snapshot){ .time = now->time, .count = last - first + 1 };
		part.passport = now->passport + first, part.motion = now->motion + first;
		part.state = now->state ? now->state + first : NULL;
		part.hulls = now->hulls, part.hull = now->hull, part.terrains = now->terrains;
	}
	ob_sandbox_spend(L, MEASURED * part.count);
	ob_measure_penetration(&part, &p);
	lua_pushnumber(L, isnan(p.max_m) ? INFINITY : p.max_m); // too much work
	lua_pushnumber(L, isnan(p.mean_m) ? INFINITY : p.mean_m);
	return 2;
}

static int fail(lua_State *L)
{
	ob_expected *x = run_at(L);
	const char *why = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	if (!*why || strlen(why) >= sizeof x->failed || !ob_text_is_clean(why, strlen(why)))
		ob_sandbox_fail(L, "run:fail: expected a text of 1 to %zu bytes, as in run:fail(\"fell\")",
				sizeof x->failed - 1);
	if (!*x->failed)
		snprintf(x->failed, sizeof x->failed, "%s", why);
	return 0;
}

// run:joint("name"): value and rate of its first axis.
static int joint(lua_State *L)
{
	const ob_expected *x = run_at(L);
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	uint32_t i = 0;
	while (i < x->scene->joints && strcmp(x->scene->joint[i].name, name) != 0)
		i++;
	ob_sandbox_spend(L, 32 + i / 4);
	if (i == x->scene->joints)
		ob_sandbox_fail(L, "run:joint: no joint \"%.47s\" in the scene", name);
	const ob_joint_passport *j = &x->scene->joint[i];
	ob_state end[2] = { { .pose.q = ob_quat_identity() }, { .pose.q = ob_quat_identity() } };
	for (int side = 0; side < 2; side++)
		if (j->object[side] != OB_JOINT_WORLD)
			end[side] = ob_snapshot_state(x->now, j->object[side]);
	double value = 0, rate = 0;
	if (!ob_joint_value(j, end, &value, &rate))
		ob_sandbox_fail(L, "run:joint: a joint of this kind has no axis: \"%s\"", name);
	lua_pushnumber(L, value);
	lua_pushnumber(L, rate);
	return 2;
}

// Fields of the run by their names, methods of upvalue 1, objects by theirs.
static int run_index(lua_State *L)
{
	ob_expected *x = run_at(L);
	const ob_snapshot *now = x->now;
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	lua_pushvalue(L, 2);
	if (*name && lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL)
		return 1;
	lua_settop(L, 2);
	const bool measured = strcmp(name, "energy") == 0 || strcmp(name, "momentum") == 0 ||
			      strcmp(name, "angular_momentum") == 0 || strcmp(name, "gap") == 0;
	if (measured)
		ob_sandbox_spend(L, MEASURED * (now->count + now->joints));
	if (strcmp(name, "time") == 0)
		lua_pushnumber(L, now->time);
	else if (strcmp(name, "step") == 0)
		lua_pushnumber(L, x->settings->step_length);
	else if (strcmp(name, "tolerance") == 0)
		lua_pushnumber(L, x->settings->tolerance);
	else if (strcmp(name, "energy") == 0)
		lua_pushnumber(L, ob_measure_energy(now, x->scene->run.gravity));
	else if (strcmp(name, "momentum") == 0)
		ob_vector_push(L, ob_measure_momentum(now));
	else if (strcmp(name, "angular_momentum") == 0)
		ob_vector_push(L, ob_measure_angular_momentum(now));
	else if (strcmp(name, "gap") == 0)
		lua_pushnumber(L, ob_measure_gap(now));
	else if (strcmp(name, "bodies") == 0)
		push_bodies(L, x);
	else if (is_there(x, find_object(L, x, 2)))
		push_body(L, x, find_object(L, x, 2), false);
	else
		lua_pushnil(L);
	return 1;
}

static int body_index(lua_State *L)
{
	const body *b = luaL_testudata(L, 1, body_kind);
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
	if (!b || !b->of->now)
		ob_sandbox_fail(L, "run: an object is looked at while a function of expect or watch is called");
	const ob_passport *p = &b->of->now->passport[b->id];
	const ob_state start = b->of->scene->object[b->id].state,
		       now = b->start ? start : ob_snapshot_state(b->of->now, b->id);
	ob_sandbox_spend(L, 8);
	if (strcmp(name, "at") == 0)
		ob_vector_push(L, now.pose.p);
	else if (strcmp(name, "velocity") == 0)
		ob_vector_push(L, now.v);
	else if (strcmp(name, "spin") == 0)
		ob_vector_push(L, now.w);
	else if (strcmp(name, "turn") == 0)
		ob_rotation_push(L, now.pose.q);
	else if (strcmp(name, "moved") == 0)
		ob_vector_push(L, ob_sub(now.pose.p, start.pose.p));
	else if (strcmp(name, "start") == 0)
		push_body(L, b->of, b->id, true);
	else if (strcmp(name, "mass") == 0)
		lua_pushnumber(L, p->mass);
	else if (strcmp(name, "inertia") == 0)
		ob_vector_push(L, p->inertia);
	else if (strcmp(name, "name") == 0)
		lua_pushstring(L, p->name);
	else
		ob_sandbox_fail(L,
				"run: an object has no \"%.40s\", only at, velocity, spin, turn, moved, start, mass, "
				"inertia and name",
				name);
	return 1;
}

static void make_kinds(lua_State *L)
{
	static const luaL_Reg methods[] = {
		{ "penetration", penetration }, { "fail", fail }, { "joint", joint }, { NULL, NULL }
	};
	luaL_newmetatable(L, body_kind);
	lua_pushcfunction(L, body_index);
	lua_setfield(L, -2, "__index");
	luaL_newmetatable(L, run_kind);
	lua_newtable(L);
	luaL_setfuncs(L, methods, 0);
	lua_pushcclosure(L, run_index, 1);
	lua_setfield(L, -2, "__index");
	lua_pop(L, 2);
}

// ---- calls

// Pushes the run, which is made once.
static void push_run(lua_State *L, ob_expected *x)
{
	if (!x->run) {
		make_kinds(L);
		*(ob_expected **)lua_newuserdatauv(L, sizeof x, 0) = x;
		luaL_setmetatable(L, run_kind);
		x->run = luaL_ref(L, LUA_REGISTRYINDEX);
	}
	lua_rawgeti(L, LUA_REGISTRYINDEX, x->run);
}

// Calls the function of the reference at index 2 for the expectations at index 1, and notes its value.
static int evaluate(lua_State *L)
{
	ob_expected *x = lua_touserdata(L, 1);
	lua_rawgeti(L, LUA_REGISTRYINDEX, lua_tointeger(L, 2));
	push_run(L, x);
	lua_call(L, 1, 1);
	x->got = lua_tonumber(L, -1);
	x->said[0] = 0;
	if (lua_type(L, -1) != LUA_TNUMBER || isnan(x->got))
		ob_text_of_value(L, -1, x->said);
	return 0;
}

static bool call(ob_expected *x, int function, ob_error *e)
{
	lua_State *L = ob_sandbox_lua(x->sandbox);
	lua_pushcfunction(L, evaluate);
	lua_pushlightuserdata(L, x);
	lua_pushinteger(L, function);
	return ob_sandbox_call(x->sandbox, 2, e);
}

static bool ask(ob_expected *x, ob_expectation *one, ob_error *e)
{
	if (!call(x, one->function, e))
		return false;
	if (*x->said)
		return ob_fail(e, "%s:%d: expect \"%s\": expected a number from its function, got %s at %s s",
			       x->scene->path, one->line, one->name, x->said, ob_number_text(x->now->time).text);
	if (!one->worst || x->got > one->value)
		one->value = x->got;
	return true;
}

static bool ask_all(ob_expected *x, bool worst, ob_error *e)
{
	for (uint32_t i = 0; i < x->count; i++)
		if (x->expectation[i].worst == worst && !ask(x, &x->expectation[i], e))
			return false;
	return true;
}

bool ob_expected_end(ob_expected *x, const ob_snapshot *now, const ob_run_settings *settings, ob_error *e)
{
	if (x->ended)
		return true;
	x->ended = true;
	x->now = now, x->settings = settings;
	const bool fine = ask_all(x, false, e);
	x->now = NULL;
	return fine;
}

bool ob_expected_look(ob_expected *x, const ob_snapshot *now, const ob_run_settings *settings, ob_error *e)
{
	bool fine = true;
	if (x->ended)
		return true;
	x->now = now, x->settings = settings;
	for (int i = 0; i < x->watches && fine; i++)
		fine = call(x, x->watch[i], e);
	fine = fine && ask_all(x, true, e);
	x->now = NULL;
	return fine && (!*x->failed || ob_expected_end(x, now, settings, e));
}

bool ob_expectation_is_met(const ob_expectation *x)
{
	return isnan(x->limit) || x->value <= x->limit;
}

void ob_expected_free(ob_expected *x)
{
	if (!x)
		return;
	ob_sandbox_destroy(x->sandbox);
	free(x);
}
