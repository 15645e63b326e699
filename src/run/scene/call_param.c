// param(name, default [, { min =, max =, whole =, label =, unit = } or { choices }]): a value that the command line may replace
// (-D name=value), by a number or an expression with a number as result (-D name=1/3).
#include <ctype.h>
#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/allocate.h"
#include "base/number.h"
#include "base/spelling.h"
#include "scene/builder.h"
#include "scene/sandbox.h"
#include "scene/text.h"

typedef struct limits {
	double min, max; // NaN: none
	bool whole; // a count: fractions are refused
	const char *label, *unit; // on the page
} limits;

static const ob_field limit_fields[] = {
	OB_FIELD(limits, min, .name = "min", .kind = OB_FIELD_NUMBER, .low = -INFINITY, .high = INFINITY),
	OB_FIELD(limits, max, .name = "max", .kind = OB_FIELD_NUMBER, .low = -INFINITY, .high = INFINITY),
	OB_FIELD(limits, whole, .name = "whole", .kind = OB_FIELD_BOOLEAN),
	OB_FIELD(limits, label, .name = "label", .kind = OB_FIELD_TEXT, .high = sizeof((ob_param_def *)0)->label - 1),
	OB_FIELD(limits, unit, .name = "unit", .kind = OB_FIELD_TEXT, .high = sizeof((ob_param_def *)0)->unit - 1),
};

// Text after "name=" in the last -D of that name; NULL: there is none.
static const char *defined(const ob_scene_options *o, const char *name)
{
	size_t n = strlen(name);
	for (uint32_t i = o->define_count; i-- > 0;)
		if (strncmp(o->defines[i], name, n) == 0 && o->defines[i][n] == '=')
			return o->defines[i] + n + 1;
	return NULL;
}

static void remember(lua_State *L, ob_builder *b, const char *name)
{
	for (uint32_t i = 0; i < b->params; i++)
		if (strcmp(b->param[i], name) == 0)
			return;
	if (b->params == OB_SCENE_PARAMS_MAX)
		ob_sandbox_fail(L, "param: expected at most %d parameters", OB_SCENE_PARAMS_MAX);
	snprintf(b->param[b->params++], OB_NAME_MAX, "%s", name);
}

const char *ob_builder_defined(lua_State *L, ob_builder *b, const char *name)
{
	remember(L, b, name);
	return defined(b->options, name);
}

static const char *check_name(lua_State *L)
{
	size_t size;
	const char *name = lua_type(L, 1) == LUA_TSTRING ? lua_tolstring(L, 1, &size) : NULL;
	if (!name || size == 0 || size >= OB_NAME_MAX || strchr(name, '=') || !ob_text_is_clean(name, size))
		ob_sandbox_fail(L, "param: expected a name of 1 to %d bytes as the first value", OB_NAME_MAX - 1);
	return name;
}

// Pushes a new table of all mathematics, by their names and as "math" (pi/6, math.pi/6), but without random numbers: a
// -D must not change the scene's sequence.
static void push_mathematics(lua_State *L)
{
	lua_newtable(L);
	lua_getglobal(L, "math");
	for (lua_pushnil(L); lua_next(L, -2) != 0;) {
		lua_pushvalue(L, -2);
		lua_insert(L, -2);
		lua_rawset(L, -5);
	}
	lua_setfield(L, -2, "math");
	lua_pushnil(L);
	lua_setfield(L, -2, "random");
}

// Pushes the number that an expression of Lua yields: 1/3, 2^10, pi/6. false: another result is pushed.
static bool push_expression(lua_State *L, const char *text)
{
	lua_pushfstring(L, "return (%s\n)", text);
	size_t size;
	const char *chunk = lua_tolstring(L, -1, &size);
	if (luaL_loadbufferx(L, chunk, size, "=-D", "t") != LUA_OK)
		return false;
	push_mathematics(L);
	lua_setupvalue(L, -2, 1); // the chunk's globals
	return lua_pcall(L, 0, 1, 0) == LUA_OK && lua_type(L, -1) == LUA_TNUMBER;
}

static limits read_limits(lua_State *L, const char *name)
{
	char where[OB_NAME_MAX + 8];
	snprintf(where, sizeof where, "param.%s", name);
	limits l = { .min = NAN, .max = NAN };
	if (!lua_isnil(L, 3))
		ob_fields_read(L, 3, where, limit_fields, sizeof limit_fields / sizeof *limit_fields, &l);
	return l;
}

// Replaces a whole number at the top, as 1e3 or 6/2 is one, by an integer of Lua; false: it has a fraction.
static bool make_integer(lua_State *L)
{
	int is_whole;
	const lua_Integer i = lua_tointegerx(L, -1, &is_whole);
	if (is_whole)
		lua_pushinteger(L, i);
	return is_whole;
}

// Pushes the number of a -D's text, or the default at index 2. With a whole default, names and loops get integers as long
// as the number is one.
static void push_number(lua_State *L, const char *name, const char *text, bool whole)
{
	const char *expected =
		whole ? "a whole number (12, 3*4), as the scene says whole = true" : "a number (.5, 1/3, pi/6)";
	if (!text)
		lua_pushvalue(L, 2);
	else if (!(lua_stringtonumber(L, text) || push_expression(L, text)) || !isfinite(lua_tonumber(L, -1)))
		ob_sandbox_fail(L, "param.%s: expected %s, got -D %s=%.80s", name, expected, name, text);
	const bool integer = (whole || lua_isinteger(L, 2)) && make_integer(L);
	if (whole && !integer && text)
		ob_sandbox_fail(L, "param.%s: expected %s, got -D %s=%.80s", name, expected, name, text);
	if (whole && !integer)
		ob_fields_fail(L, "param", name, "a whole number as default, as it says whole = true", 2);
	if (!integer)
		lua_pushnumber(L, lua_tonumber(L, -1));
}

// Keeps a number within limits for viewers, who may change it.
static void offer(lua_State *L, ob_scene *s, const char *name, const limits *l)
{
	uint32_t i = 0;
	while (i < s->params && strcmp(s->param[i].name, name) != 0)
		i++;
	if (i == s->params) {
		if (!OB_GROW(s->param, i + 1))
			ob_sandbox_fail(L, "param.%s: no memory left on this machine", name);
		s->params++;
	}
	s->param[i] = (ob_param_def){ .value = lua_tonumber(L, -1), .min = l->min, .max = l->max, .whole = l->whole };
	snprintf(s->param[i].name, sizeof s->param[i].name, "%s", name);
	snprintf(s->param[i].label, sizeof s->param[i].label, "%s", l->label ? l->label : "");
	snprintf(s->param[i].unit, sizeof s->param[i].unit, "%s", l->unit ? l->unit : "");
}

// Pushes the number within the limits at index 3, and keeps one that has both.
static void take_number(lua_State *L, const char *name, const char *text)
{
	const limits l = read_limits(L, name);
	push_number(L, name, text, l.whole);
	const double x = lua_tonumber(L, -1);
	if (x < l.min)
		ob_sandbox_fail(L, "param.%s: expected a number of at least %s, got %s", name,
				ob_number_text(l.min).text, ob_number_text(x).text);
	if (x > l.max)
		ob_sandbox_fail(L, "param.%s: expected a number of at most %s, got %s", name,
				ob_number_text(l.max).text, ob_number_text(x).text);
	if (isfinite(l.min) && isfinite(l.max))
		offer(L, ((ob_builder *)ob_sandbox_user(L))->scene, name, &l);
}

// Pushes the text, which is one of { "one", "two" } at index 3.
static void take_text(lua_State *L, const char *name, const char *given)
{
	if (given)
		lua_pushstring(L, given);
	else
		lua_pushvalue(L, 2);
	if (lua_isnil(L, 3))
		return;
	char known[160] = "";
	size_t n = 0, count = lua_istable(L, 3) ? lua_rawlen(L, 3) : 0;
	const char *text = lua_tostring(L, -1);
	if (count == 0)
		ob_sandbox_fail(L, "param.%s: expected a list of choices as the third value", name);
	for (size_t i = 1; i <= count; i++) {
		const char *choice = lua_rawgeti(L, 3, (lua_Integer)i) == LUA_TSTRING ? lua_tostring(L, -1) : "";
		lua_pop(L, 1);
		if (strcmp(choice, text) == 0)
			return;
		if (n < sizeof known)
			n += (size_t)snprintf(known + n, sizeof known - n, "%s\"%s\"", i > 1 ? " or " : "", choice);
	}
	ob_sandbox_fail(L, "param.%s: expected %s, got \"%.80s\"", name, known, text);
}

static void take_boolean(lua_State *L, const char *name, const char *text)
{
	if (text && strcmp(text, "true") != 0 && strcmp(text, "false") != 0)
		ob_sandbox_fail(L, "param.%s: expected true or false, got -D %s=%.80s", name, name, text);
	if (!lua_isnil(L, 3))
		ob_sandbox_fail(L, "param.%s: expected no third value for true or false", name);
	lua_pushboolean(L, text ? text[0] == 't' : lua_toboolean(L, 2));
}

int ob_scene_call_param(lua_State *L)
{
	ob_builder *b = ob_sandbox_user(L);
	const char *name = check_name(L);
	lua_settop(L, 3);
	int type = lua_type(L, 2);
	if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
		ob_fields_fail(L, "param", name, "a default that is a number, text, true or false", 2);
	const char *text = ob_builder_defined(L, b, name);
	if (type == LUA_TNUMBER)
		take_number(L, name, text);
	else if (type == LUA_TSTRING)
		take_text(L, name, text);
	else
		take_boolean(L, name, text);
	return 1;
}

static void list_params(const ob_builder *b, char *out, size_t size)
{
	size_t n = (size_t)snprintf(out, size, "%s", b->params ? "" : "none");
	for (uint32_t i = 0; i < b->params && n < size; i++)
		n += (size_t)snprintf(out + n, size - n, "%s%s", i ? ", " : "", b->param[i]);
}

static bool check_define(const ob_builder *b, const char *path, const char *define, ob_error *e)
{
	char name[OB_NAME_MAX], list[400];
	const char *equal = strchr(define, '=');
	if (!equal || equal == define)
		return ob_fail(e, "-D %.80s: expected name=value", define);
	snprintf(name, sizeof name, "%.*s", (int)(equal - define), define);
	ob_spelling spelling = ob_spelling_start(name);
	for (uint32_t i = 0; i < b->params; i++) {
		size_t n = strlen(b->param[i]);
		if (n == (size_t)(equal - define) && strncmp(b->param[i], define, n) == 0)
			return true;
		ob_spelling_offer(&spelling, b->param[i]);
	}
	list_params(b, list, sizeof list);
	if (spelling.best)
		return ob_fail(e, "%s: -D %.80s: unknown parameter, did you mean %s? The scene has %s", path, define,
			       spelling.best, list);
	return ob_fail(e, "%s: -D %.80s: unknown parameter; the scene has %s", path, define, list);
}

bool ob_builder_check_defines(const ob_builder *b, const char *path, ob_error *e)
{
	for (uint32_t i = 0; i < b->options->define_count; i++)
		if (!check_define(b, path, b->options->defines[i], e))
			return false;
	return true;
}

// ---- call controls

// controls { key = "w", sends = "walk", values = { 1, 0 } }: keys, buttons and sliders of viewers.

typedef struct control {
	const char *key, *label, *sends, *to;
	uint32_t gamepad; // OB_CONTROL_BUTTONS: none
	bool values;
	double min, max, value; // NaN: not set
} control;

#define F(member, ...) OB_FIELD(control, member, .name = #member, __VA_ARGS__)
#define NUMBER(member) F(member, .kind = OB_FIELD_NUMBER, .low = -1e9, .high = 1e9)
static const ob_field fields[] = {
	F(key, .kind = OB_FIELD_TEXT, .high = OB_CONTROL_KEY - 1),
	F(gamepad, .kind = OB_FIELD_COUNT, .high = OB_CONTROL_BUTTONS - 1),
	F(label, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
	F(sends, .kind = OB_FIELD_TEXT, .high = 15, .required = true),
	F(to, .kind = OB_FIELD_TEXT, .high = OB_NAME_MAX - 1),
	F(values, .kind = OB_FIELD_TABLE),
	NUMBER(min),
	NUMBER(max),
	NUMBER(value),
};
#undef F
#undef NUMBER

static void read_values(lua_State *L, ob_control_def *c)
{
	lua_getfield(L, 1, "values");
	const size_t n = lua_rawlen(L, -1);
	bool fine = n > 0 && n <= OB_CONTROL_VALUES;
	for (size_t i = 0; fine && i < n; i++) {
		fine = lua_rawgeti(L, -1, (lua_Integer)i + 1) == LUA_TNUMBER;
		c->value[i] = lua_tonumber(L, -1);
		fine = fine && fabs(c->value[i]) <= 1e9;
		lua_pop(L, 1);
	}
	lua_pop(L, 1);
	if (!fine)
		ob_sandbox_fail(L, "controls.values: expected 1 to %d numbers from -1e9 to 1e9, as { 1, 0 }",
				OB_CONTROL_VALUES);
	c->values = (uint32_t)n;
}

static void check(lua_State *L, const control *c)
{
	const bool low = !isnan(c->min), high = !isnan(c->max);
	const bool pressed = c->key || c->gamepad < OB_CONTROL_BUTTONS;
	if (!pressed && !c->label)
		ob_sandbox_fail(L, "controls: expected a key, a gamepad's button, or a label of a button or slider");
	if (strpbrk(c->sends, " \t"))
		ob_sandbox_fail(L, "controls.sends: expected one word, got \"%s\"", c->sends);
	if (low != high || (low && c->min >= c->max))
		ob_sandbox_fail(L, "controls.max: expected min and max of a slider, the smaller one first");
	if (low && (pressed || c->values || !c->label))
		ob_sandbox_fail(L, "controls.min: expected a label, and neither key, gamepad nor values, for a slider");
	if (!isnan(c->value) && (!low || c->value < c->min || c->value > c->max))
		ob_sandbox_fail(L, "controls.value: expected a number from min to max of a slider");
}

int ob_scene_call_controls(lua_State *L)
{
	ob_scene *s = ((ob_builder *)ob_sandbox_user(L))->scene;
	control c = { .gamepad = OB_CONTROL_BUTTONS, .min = NAN, .max = NAN, .value = NAN };
	ob_fields_read(L, 1, "controls", fields, sizeof fields / sizeof *fields, &c);
	check(L, &c);
	if (s->controls == OB_SCENE_CONTROLS_MAX || !OB_GROW(s->control, s->controls + 1))
		ob_sandbox_fail(L, "controls: expected at most %d controls in a scene", OB_SCENE_CONTROLS_MAX);
	ob_control_def *d = &s->control[s->controls++];
	*d = (ob_control_def){ .gamepad = c.gamepad, .slider = !isnan(c.min), .min = c.min, .max = c.max };
	snprintf(d->key, sizeof d->key, "%s", c.key ? c.key : "");
	for (char *at = d->key; d->key[0] && !d->key[1] && *at; at++)
		*at = (char)tolower((unsigned char)*at);
	snprintf(d->label, sizeof d->label, "%s", c.label ? c.label : "");
	snprintf(d->sends, sizeof d->sends, "%s", c.sends);
	snprintf(d->to, sizeof d->to, "%s", c.to ? c.to : "");
	if (c.values)
		read_values(L, d);
	if (d->slider)
		d->value[0] = isnan(c.value) ? c.min : c.value;
	return 0;
}

static bool receives(const ob_scene *s, const char *name, ob_spelling *spelling)
{
	for (uint32_t i = 0; i < s->objects; i++) {
		if (s->object[i].script && strcmp(s->object[i].passport.name, name) == 0)
			return true;
		if (s->object[i].script)
			ob_spelling_offer(spelling, s->object[i].passport.name);
	}
	return false;
}

bool ob_builder_check_controls(const ob_builder *b, const char *path, ob_error *e)
{
	const ob_scene *s = b->scene;
	for (uint32_t i = 0; i < s->controls; i++) {
		const char *to = s->control[i].to;
		ob_spelling spelling = ob_spelling_start(to);
		if (!*to && !s->avatar)
			return ob_fail(
				e,
				"%s:1: controls \"%s\": expected an object with avatar = true, or to = \"NAME\" of an "
				"object with a script",
				path, s->control[i].sends);
		if (*to && !receives(s, to, &spelling))
			return ob_fail(
				e, "%s:1: controls.to: expected the name of an object with a script, got \"%s\"%s%s%s",
				path, to, spelling.best ? ", did you mean \"" : "", spelling.best ? spelling.best : "",
				spelling.best ? "\"?" : "");
	}
	return true;
}
