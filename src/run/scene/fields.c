#include "scene/fields.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <lauxlib.h>
#include <ob/vec.h>

#include "base/number.h"
#include "base/spelling.h"
#include "elementary/elementary.h"
#include "scene/flat.h"
#include "scene/sandbox.h"
#include "scene/scene.h"
#include "scene/text.h"
#include "scene/vector.h"
#include "settings/settings.h"

// Reader of one field, whose value is at the top of the stack.
typedef struct reader {
	lua_State *L;
	const char *where;
	const ob_field *field;
	void *to; // the field in the target
} reader;

_Noreturn void ob_fields_fail(lua_State *L, const char *where, const char *field, const char *expected, int index)
{
	char got[OB_TEXT_VALUE];
	ob_text_of_value(L, index, got);
	ob_sandbox_fail(L, "%s.%s: expected %s, got %s", where, field, expected, got);
}

static _Noreturn void fail(const reader *r, const char *expected)
{
	ob_fields_fail(r->L, r->where, r->field->name, expected, -1);
}

// "a number from 0 to 1", "three numbers above 0", "a whole number of at least 1"
static _Noreturn void fail_range(const reader *r, const char *what)
{
	const ob_field *f = r->field;
	char expected[160];
	if (f->above && f->high == INFINITY)
		snprintf(expected, sizeof expected, "%s above %s", what, ob_number_text(f->low).text);
	else if (f->above)
		snprintf(expected, sizeof expected, "%s above %s, up to %s", what, ob_number_text(f->low).text,
			 ob_number_text(f->high).text);
	else if (f->high == INFINITY)
		snprintf(expected, sizeof expected, "%s of at least %s", what, ob_number_text(f->low).text);
	else
		snprintf(expected, sizeof expected, "%s from %s to %s", what, ob_number_text(f->low).text,
			 ob_number_text(f->high).text);
	fail(r, expected);
}

static bool fits(const ob_field *f, double x)
{
	return isfinite(x) && x >= f->low && x <= f->high && !(f->above && x == f->low);
}

static void read_number(const reader *r)
{
	double x = lua_tonumber(r->L, -1);
	if (lua_type(r->L, -1) != LUA_TNUMBER || !fits(r->field, x))
		fail_range(r, "a number");
	*(double *)r->to = x;
}

static double read_integer(const reader *r)
{
	double x = lua_tonumber(r->L, -1);
	if (lua_type(r->L, -1) != LUA_TNUMBER || !fits(r->field, x) || x != floor(x))
		fail_range(r, "a whole number");
	return x;
}

static void read_whole(const reader *r)
{
	*(uint64_t *)r->to = (uint64_t)read_integer(r);
}

static void read_count(const reader *r)
{
	*(uint32_t *)r->to = (uint32_t)read_integer(r);
}

static bool is_true(const reader *r)
{
	if (!lua_isboolean(r->L, -1))
		fail(r, "true or false");
	return lua_toboolean(r->L, -1);
}

static void read_boolean(const reader *r)
{
	*(bool *)r->to = is_true(r);
}

static void read_switch(const reader *r)
{
	*(uint32_t *)r->to = is_true(r);
}

static void read_choice(const reader *r)
{
	const char *text = lua_type(r->L, -1) == LUA_TSTRING ? lua_tostring(r->L, -1) : "";
	if (ob_setting_find(r->field->choices, text, r->to))
		return;
	char expected[160];
	size_t n = 0;
	for (const char *c = r->field->choices; *c; c += *c == '|') {
		size_t length = strcspn(c, "|");
		n += (size_t)snprintf(expected + n, sizeof expected - n, "%s\"%.*s\"", n ? " or " : "", (int)length, c);
		c += length;
	}
	fail(r, expected);
}

static void read_text(const reader *r)
{
	size_t size;
	const char *text = lua_type(r->L, -1) == LUA_TSTRING ? lua_tolstring(r->L, -1, &size) : NULL;
	if (!text || size == 0 || (double)size > r->field->high || !ob_text_is_clean(text, size)) {
		char expected[80];
		snprintf(expected, sizeof expected, "text of 1 to %.0f bytes without control characters",
			 r->field->high);
		fail(r, expected);
	}
	*(const char **)r->to = text;
}

// Reads exactly count numbers, {1, 2, 3}, or a vector.
static bool list(lua_State *L, size_t count, double *out)
{
	const ob_vec3 *v = count == 3 ? ob_vector_at(L, -1) : NULL;
	if (v) {
		memcpy(out, v, sizeof *v);
		return ob_is_finite(*v);
	}
	if (!lua_istable(L, -1) || lua_rawlen(L, -1) != count)
		return false;
	size_t entries = 0;
	lua_pushnil(L);
	while (lua_next(L, -2)) {
		entries++;
		lua_pop(L, 1);
	}
	bool good = entries == count;
	for (size_t i = 0; i < count && good; i++) {
		good = lua_rawgeti(L, -1, (lua_Integer)i + 1) == LUA_TNUMBER;
		out[i] = lua_tonumber(L, -1);
		good = good && isfinite(out[i]);
		lua_pop(L, 1);
	}
	return good;
}

static void read_vector(const reader *r)
{
	double x[3];
	bool good = list(r->L, 3, x);
	for (int i = 0; i < 3 && good; i++)
		good = fits(r->field, x[i]);
	if (!good)
		fail_range(r, "three numbers {x, y, z}, each");
	*(ob_vec3 *)r->to = ob_v3(x[0], x[1], x[2]);
}

// Reads points into memory that Lua owns, valid until the next list is read.
static void read_points(const reader *r)
{
	lua_State *L = r->L;
	const size_t n = lua_istable(L, -1) ? lua_rawlen(L, -1) : 0;
	if (n < 1 || n > OB_FIELD_POINTS_MAX) {
		char expected[80];
		snprintf(expected, sizeof expected, "a list of 4 to %d points {x, y, z}", OB_FIELD_POINTS_MAX);
		fail(r, expected);
	}
	ob_vec3 *at = lua_newuserdatauv(L, n * sizeof *at, 0);
	lua_setfield(L, LUA_REGISTRYINDEX, "scene.points");
	for (size_t i = 0; i < n; i++) {
		char name[64];
		ob_field each = *r->field;
		snprintf(name, sizeof name, "%s[%zu]", r->field->name, i + 1);
		each.name = name;
		lua_rawgeti(L, -1, (lua_Integer)i + 1);
		read_vector(&(reader){ L, r->where, &each, &at[i] });
		lua_pop(L, 1);
	}
	*(ob_points *)r->to = (ob_points){ at, (uint32_t)n };
}

// Normalises a vector. Scales it by its largest component first, so that squares neither underflow nor overflow; false:
// it has no direction.
static bool make_unit(double *x, int n)
{
	double largest = 0, sum = 0;
	for (int i = 0; i < n; i++)
		largest = fmax(largest, fabs(x[i]));
	if (largest == 0)
		return false;
	for (int i = 0; i < n; i++) {
		x[i] /= largest;
		sum += x[i] * x[i];
	}
	for (int i = 0; i < n; i++)
		x[i] /= sqrt(sum);
	return true;
}

static void read_direction(const reader *r)
{
	double x[3];
	if (!list(r->L, 3, x) || !make_unit(x, 3))
		fail(r, "a direction {x, y, z} that is not {0, 0, 0}");
	*(ob_vec3 *)r->to = ob_v3(x[0], x[1], x[2]);
}

static void read_quaternion(const reader *r)
{
	double x[4];
	const ob_quat *q = ob_rotation_at(r->L, -1);
	if (q) {
		*(ob_quat *)r->to = *q;
		return;
	}
	if (!list(r->L, 4, x) || !make_unit(x, 4))
		fail(r, "a quaternion {w, x, y, z} that is not {0, 0, 0, 0}");
	*(ob_quat *)r->to = (ob_quat){ x[0], x[1], x[2], x[3] };
}

typedef struct rotation {
	ob_vec3 axis;
	double degrees;
} rotation;

static const ob_field rotation_fields[] = {
	OB_FIELD(rotation, axis, .name = "axis", .kind = OB_FIELD_DIRECTION, .required = true),
	OB_FIELD(rotation, degrees, .name = "degrees", .kind = OB_FIELD_NUMBER, .low = -36000, .high = 36000,
		 .required = true),
};

static void read_rotation(const reader *r)
{
	if (!lua_istable(r->L, -1))
		fail(r, "{ axis = {x, y, z}, degrees = angle }");
	char where[64];
	snprintf(where, sizeof where, "%s.%s", r->where, r->field->name);
	rotation t;
	ob_fields_read(r->L, -1, where, rotation_fields, 2, &t);
	*(ob_quat *)r->to = ob_quat_turn(ob_quat_identity(), ob_scale(t.axis, t.degrees * (M_PI / 180)));
}

void ob_colour_from_srgb(const double rgba[4], float linear[4])
{
	for (int i = 0; i < 3; i++) // IEC 61966-2-1
		linear[i] = (float)(rgba[i] <= .04045 ? rgba[i] / 12.92 : ob_pow((rgba[i] + .055) / 1.055, 2.4));
	linear[3] = (float)rgba[3];
}

static int hex_digit(char c)
{
	return isdigit((unsigned char)c) ? c - '0' : tolower((unsigned char)c) - 'a' + 10;
}

bool ob_colour_from_hex(const char *text, float linear[4])
{
	size_t n = strlen(text);
	if (text[0] != '#' || (n != 7 && n != 9))
		return false;
	double rgba[4] = { 0, 0, 0, 1 };
	for (size_t i = 1; i < n; i += 2) {
		if (!isxdigit((unsigned char)text[i]) || !isxdigit((unsigned char)text[i + 1]))
			return false;
		rgba[i / 2] = (16 * hex_digit(text[i]) + hex_digit(text[i + 1])) / 255.;
	}
	ob_colour_from_srgb(rgba, linear);
	return rgba[3] == 1;
}

bool ob_scene_read_colour(const char *text, float linear[4])
{
	return ob_colour_from_hex(text, linear);
}

static void read_colour(const reader *r)
{
	double rgba[4] = { 0, 0, 0, 1 };
	if (lua_type(r->L, -1) == LUA_TSTRING && ob_colour_from_hex(lua_tostring(r->L, -1), r->to))
		return;
	bool good = list(r->L, 3, rgba) || list(r->L, 4, rgba);
	for (int i = 0; i < 4 && good; i++)
		good = rgba[i] >= 0 && rgba[i] <= 1;
	if (!good || rgba[3] != 1)
		fail(r, "a colour {r, g, b} of numbers from 0 to 1, or \"#rrggbb\", opaque as all that is drawn");
	ob_colour_from_srgb(rgba, r->to);
}

static void read_flat(const reader *r)
{
	char what[64];
	snprintf(what, sizeof what, "%s.%s", r->where, r->field->name);
	if (!lua_istable(r->L, -1))
		fail(r, "a table of values, as in { speed = 3 }");
	ob_flat *f = r->to;
	f->size = 0;
	ob_flat_put_table(r->L, -1, f, what);
}

static void read_source(const reader *r)
{
	size_t size;
	const char *text = lua_type(r->L, -1) == LUA_TSTRING ? lua_tolstring(r->L, -1, &size) : NULL;
	if (!text || size == 0 || (double)size > r->field->high || memchr(text, 0, size))
		fail(r, "the name of a script, of a file that ends with .lua, or a script as text");
	*(const char **)r->to = text;
}

static void read_length(const reader *r)
{
	ob_length *to = r->to;
	if (lua_type(r->L, -1) == LUA_TSTRING) {
		if (!ob_length_read(lua_tostring(r->L, -1), to))
			fail(r, OB_LENGTH_FORMS);
		if (!(to->share > 0) && !fits(r->field, to->m))
			fail_range(r, "a length (m)");
	} else {
		reader number = *r;
		number.to = &to->m;
		read_number(&number);
	}
}

static void read_set(const reader *r)
{
	uint32_t set = 0;
	const size_t n = lua_istable(r->L, -1) ? lua_rawlen(r->L, -1) : 0;
	size_t entries = 0;
	if (!lua_istable(r->L, -1))
		fail_range(r, "a list of whole numbers, each");
	lua_pushnil(r->L);
	for (; lua_next(r->L, -2); entries++)
		lua_pop(r->L, 1);
	if (entries != n)
		fail_range(r, "a list of whole numbers, each");
	for (size_t i = 0; i < n; i++) {
		char name[64];
		ob_field each = *r->field;
		snprintf(name, sizeof name, "%s[%zu]", r->field->name, i + 1);
		each.name = name;
		lua_rawgeti(r->L, -1, (lua_Integer)i + 1);
		set |= UINT32_C(1) << (uint32_t)read_integer(&(reader){ r->L, r->where, &each, NULL });
		lua_pop(r->L, 1);
	}
	*(uint32_t *)r->to = set;
}

static void read_table(const reader *r)
{
	if (!lua_istable(r->L, -1))
		fail(r, "a table");
	*(bool *)r->to = true;
}

static void read_function(const reader *r)
{
	if (!lua_isfunction(r->L, -1))
		fail(r, "a function");
	*(bool *)r->to = true;
}

static void (*const read_kind[])(const reader *r) = {
	[OB_FIELD_NUMBER] = read_number,       [OB_FIELD_WHOLE] = read_whole,
	[OB_FIELD_COUNT] = read_count,         [OB_FIELD_BOOLEAN] = read_boolean,
	[OB_FIELD_SWITCH] = read_switch,       [OB_FIELD_TEXT] = read_text,
	[OB_FIELD_CHOICE] = read_choice,       [OB_FIELD_VECTOR] = read_vector,
	[OB_FIELD_DIRECTION] = read_direction, [OB_FIELD_QUATERNION] = read_quaternion,
	[OB_FIELD_ROTATION] = read_rotation,   [OB_FIELD_POINTS] = read_points,
	[OB_FIELD_COLOUR] = read_colour,       [OB_FIELD_FLAT] = read_flat,
	[OB_FIELD_SOURCE] = read_source,       [OB_FIELD_TABLE] = read_table,
	[OB_FIELD_LENGTH] = read_length,       [OB_FIELD_SET] = read_set,
	[OB_FIELD_FUNCTION] = read_function,
};

static _Noreturn void fail_unknown(lua_State *L, const char *where, const char *name, const ob_field *field,
				   size_t count)
{
	ob_spelling spelling = ob_spelling_start(name);
	for (size_t i = 0; i < count; i++)
		ob_text_offer(&spelling, field[i].name);
	if (spelling.best)
		ob_sandbox_fail(L, "%s.%.40s: unknown field, did you mean %s?", where, name, spelling.best);
	char known[240];
	size_t n = 0;
	known[0] = 0;
	for (size_t i = 0; i < count && n < sizeof known; i++)
		n += (size_t)snprintf(known + n, sizeof known - n, "%s%s", i ? ", " : "", field[i].name);
	ob_sandbox_fail(L, "%s.%.40s: unknown field, expected one of %s", where, name, known);
}

// Checks a key, at index -2. Positional values are errors: every field has a name.
static void check_name(lua_State *L, const char *where, const ob_field *field, size_t count)
{
	if (lua_type(L, -2) != LUA_TSTRING) {
		char key[OB_TEXT_VALUE];
		ob_text_of_value(L, -2, key);
		ob_sandbox_fail(L, "%s: expected named fields (name = value), got a value without a name at %s", where,
				key);
	}
	const char *name = lua_tostring(L, -2);
	for (size_t i = 0; i < count; i++)
		if (strcmp(field[i].name, name) == 0)
			return;
	fail_unknown(L, where, name, field, count);
}

uint64_t ob_fields_read(lua_State *L, int index, const char *where, const ob_field *field, size_t count, void *to)
{
	index = lua_absindex(L, index);
	luaL_checkstack(L, 8, "nested too deep");
	if (!lua_istable(L, index)) {
		char got[OB_TEXT_VALUE];
		ob_text_of_value(L, index, got);
		ob_sandbox_fail(L, "%s: expected a table of fields, as in %s { ... }, got %s", where, where, got);
	}
	lua_pushnil(L);
	while (lua_next(L, index)) {
		check_name(L, where, field, count);
		lua_pop(L, 1);
	}
	uint64_t found = 0;
	for (size_t i = 0; i < count; i++) {
		reader r = { L, where, &field[i], (char *)to + field[i].offset };
		lua_pushstring(L, field[i].name);
		bool given = lua_rawget(L, index) != LUA_TNIL;
		if (given || field[i].required)
			read_kind[field[i].kind](&r);
		found |= (uint64_t)(given && i < 64) << i % 64;
		lua_pop(L, 1);
	}
	return found;
}
