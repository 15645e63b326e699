// Lua's own libraries, as far as the sandbox offers them: a list of what is known to be harmless, guards where one call could
// run without end, and a clear word where a scene asks for something else.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>
#include <lualib.h>

#include "base/log.h"
#include "base/spelling.h"
#include "scene/sandbox.h"
#include "scene/text.h"

// Work is counted in instructions of the Lua machine: about 8 ns each, and never more than 50 ns of what a call does.
#define PATTERN_STEPS 1e7 // that one pattern match may take at most
#define STEPS_PER_INSTRUCTION 16. // of the matcher; a bound of them, mostly above what it takes
#define BYTES_READ 8. // per instruction, by functions that look at each byte
#define BYTES_MADE 4. // per instruction, as in the allocator (sandbox.c)
#define NUMBER_TEXT 12. // instructions to write a number as text
#define ITERATION 2 // instructions, for the next of ipairs and pairs
#define PRINT_COST 1000 // instructions that writing a line is worth

static const char *const withheld[] = {
	"_G",           "collectgarbage", "coroutine", "debug",  "dofile", "getmetatable",
	"io",           "load",           "loadfile",  "next",   "os",     "package",
	"pcall",        "rawequal",       "rawget",    "rawlen", "rawset", "require",
	"setmetatable", "utf8",           "xpcall",    NULL
};

// A bound on the steps of Lua's matcher: each quantified item may take any of length + 1 lengths, from each start.
static double pattern_steps(const char *pattern, size_t size, size_t length)
{
	double steps = (double)(size + 1) * (double)(length + 1);
	for (size_t i = 0; i < size && steps <= PATTERN_STEPS; i++) {
		bool special = strchr("*+-", pattern[i]) != NULL;
		if (pattern[i] == '%' && i + 1 < size) {
			i++;
			special = pattern[i] == 'b' || (pattern[i] >= '0' && pattern[i] <= '9');
		}
		steps *= special ? (double)(length + 1) : pattern[i] == '?' ? 2 : 1;
	}
	return steps;
}

// ---- the account: instructions that a call is worth, from its arguments alone, before it does anything

typedef double charge(lua_State *L); // may raise an error, and may replace arguments

static double string_bytes(lua_State *L, int index)
{
	return lua_type(L, index) == LUA_TSTRING ? (double)lua_rawlen(L, index) : 0;
}

// Arguments from this index on: strings among them may be read as numbers.
static double charge_from(lua_State *L, int first)
{
	double units = lua_gettop(L) / 4.;
	for (int i = first, top = lua_gettop(L); i <= top; i++)
		units += string_bytes(L, i) / BYTES_READ;
	return units;
}

static double charge_arguments(lua_State *L)
{
	return charge_from(L, 1);
}

// The first argument is neither read nor copied.
static double charge_others(lua_State *L)
{
	return charge_from(L, 2);
}

// Values that are passed on without a look at them.
static double charge_values(lua_State *L)
{
	return lua_gettop(L) / 4.;
}

// The copy is charged where it is allocated, but for a buffer that is larger than the string.
static double charge_copy(lua_State *L)
{
	return charge_others(L) + string_bytes(L, 1) / (4 * BYTES_MADE);
}

static double charge_byte(lua_State *L)
{
	const double size = string_bytes(L, 1);
	double from = (double)luaL_optinteger(L, 2, 1), to = (double)luaL_optinteger(L, 3, (lua_Integer)from);
	from = from < 0 ? fmax(size + from, 0) : fmax(from - 1, 0);
	to = to < 0 ? size + to + 1 : fmin(to, size);
	return charge_others(L) + fmax(to - from, 0) / 4;
}

static double charge_matching(lua_State *L)
{
	size_t length, size;
	luaL_checklstring(L, 1, &length);
	const char *pattern = luaL_checklstring(L, 2, &size);
	const double steps = pattern_steps(pattern, size, length);
	if (steps > PATTERN_STEPS)
		ob_sandbox_fail(L, "pattern too costly: expected a shorter text or fewer of * + - in the pattern");
	return charge_from(L, 3) + steps / STEPS_PER_INSTRUCTION + (double)(length + size) / BYTES_MADE;
}

// Each match may go through all of a replacement that holds captures, however little comes of it.
static double charge_gsub(lua_State *L)
{
	size_t length, size = 0;
	const char *with = lua_type(L, 3) == LUA_TSTRING ? lua_tolstring(L, 3, &size) : NULL;
	const double units = charge_matching(L);
	lua_tolstring(L, 1, &length);
	return units + (with && memchr(with, '%', size) ? (double)(length + 1) * (double)size / BYTES_READ : 0);
}

// The original turns n times even where the text is empty.
static double charge_rep(lua_State *L)
{
	size_t length, between = 0;
	luaL_checklstring(L, 1, &length);
	lua_Integer n = luaL_checkinteger(L, 2);
	luaL_optlstring(L, 3, "", &between);
	const size_t each = length + between > 0 ? length + between : 1;
	const double made = n > 0 ? (double)n * (double)each : 0;
	if (made > (double)ob_sandbox_string_max(L))
		ob_sandbox_fail(L, "string.rep: %s", ob_sandbox_out_of_string(L));
	return charge_others(L) + made / (4 * BYTES_MADE) + fmax((double)n, 0) / 4;
}

static double text_units(lua_State *L, int index)
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		return NUMBER_TEXT;
	case LUA_TUSERDATA:
		return 2 * NUMBER_TEXT;
	default:
		return 1;
	}
}

static double charge_tostring(lua_State *L)
{
	return text_units(L, 1);
}

// tonumber: a digit of a number with many is work that grows.
static double charge_digits(lua_State *L)
{
	return 2 + 2 * charge_arguments(L);
}

static double charge_concat(lua_State *L)
{
	const double from = (double)luaL_optinteger(L, 3, 1);
	luaL_checktype(L, 1, LUA_TTABLE);
	const double to = (double)(lua_isnoneornil(L, 4) ? luaL_len(L, 1) : luaL_checkinteger(L, 4));
	return charge_others(L) + fmax(to - from + 1, 0) * NUMBER_TEXT;
}

// table.insert and table.remove: what they move.
static double charge_shift(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	const double n = (double)luaL_len(L, 1), at = lua_isinteger(L, 2) ? (double)lua_tointeger(L, 2) : n;
	return 2 + charge_others(L) + 1.5 * fmin(fmax(n - at, 0), n);
}

static double charge_insert(lua_State *L)
{
	return lua_gettop(L) < 3 ? 2 : charge_shift(L);
}

static double charge_unpack(lua_State *L)
{
	const double from = (double)luaL_optinteger(L, 2, 1);
	const double to = (double)(lua_isnoneornil(L, 3) ? luaL_len(L, 1) : luaL_checkinteger(L, 3));
	return charge_others(L) + fmax(to - from + 1, 0) / 2;
}

// Upvalue 1: the function that compares; nil for the order of values.
static int compare_charged(lua_State *L)
{
	ob_sandbox_spend(L, 6);
	if (lua_isnil(L, lua_upvalueindex(1))) {
		lua_pushboolean(L, lua_compare(L, 1, 2, LUA_OPLT));
		return 1;
	}
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	lua_call(L, 2, 1);
	return 1;
}

// A function of the script's own counts itself; no other would.
static double charge_sort(lua_State *L)
{
	lua_settop(L, 2);
	if (lua_isnil(L, 2) || lua_iscfunction(L, 2))
		lua_pushcclosure(L, compare_charged, 1);
	return 2;
}

// A function of Lua's library, and how its calls are charged; NULL: a value, or one for which its call is enough.
typedef struct offered {
	const char *name;
	charge *charge;
} offered;

// Calls upvalue 1 after its charge, upvalue 2.
static int call_charged(lua_State *L)
{
	const offered *o = lua_touserdata(L, lua_upvalueindex(2));
	const double units = o->charge(L);
	ob_sandbox_spend(L, units < 1e9 ? (unsigned)units : 1000000000);
	return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

// The function at the top of the stack is replaced by one that is charged.
static void put_charge(lua_State *L, const offered *o)
{
	lua_pushlightuserdata(L, (void *)(uintptr_t)o);
	lua_pushcclosure(L, call_charged, 2);
}

// An iterator that has ended would search all again: upvalue 1 is the original, and nil from then on.
static int next_match(lua_State *L)
{
	if (lua_isnil(L, lua_upvalueindex(1)))
		return 0;
	lua_settop(L, 0);
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_call(L, 0, LUA_MULTRET);
	if (lua_isnoneornil(L, 1)) {
		lua_pushnil(L);
		lua_replace(L, lua_upvalueindex(1));
	}
	return lua_gettop(L);
}

// string.gmatch: upvalue 1 is the charged one, which pays for all that the iterator will do.
static int gmatch_once(lua_State *L)
{
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	lua_call(L, lua_gettop(L) - 1, 1);
	lua_pushcclosure(L, next_match, 1);
	return 1;
}

// pairs(t) goes in a fixed order, numbers before strings before booleans: Lua's own depends on where things lie in
// memory, and differs from run to run.
static int rank(lua_State *L, int index)
{
	switch (lua_type(L, index)) {
	case LUA_TNUMBER:
		return 0;
	case LUA_TSTRING:
		return 1;
	default:
		return 2;
	}
}

// Compares bytes, independent of the locale's collation.
static bool string_less(lua_State *L)
{
	size_t n, m;
	const char *a = lua_tolstring(L, 1, &n), *b = lua_tolstring(L, 2, &m);
	int order = memcmp(a, b, n < m ? n : m);
	return order < 0 || (order == 0 && n < m);
}

static int key_less(lua_State *L)
{
	int a = rank(L, 1), b = rank(L, 2);
	bool before = a < b;
	if (a == b && a == 0)
		before = lua_compare(L, 1, 2, LUA_OPLT);
	else if (a == b && a == 1)
		before = string_less(L);
	else if (a == b)
		before = lua_toboolean(L, 1) < lua_toboolean(L, 2);
	lua_pushboolean(L, before);
	return 1;
}

// Upvalues: the table, its sorted keys, how many have been given. A key that was removed meanwhile is left out.
static int next_pair(lua_State *L)
{
	lua_Integer i = lua_tointeger(L, lua_upvalueindex(3));
	ob_sandbox_spend(L, ITERATION);
	do {
		i++;
		lua_settop(L, 0);
		if (lua_rawgeti(L, lua_upvalueindex(2), i) == LUA_TNIL)
			return 1;
		lua_pushvalue(L, 1);
	} while (lua_rawget(L, lua_upvalueindex(1)) == LUA_TNIL);
	lua_pushinteger(L, i);
	lua_replace(L, lua_upvalueindex(3));
	return 2;
}

// Charges the order of n keys, the list at index 2, by n log n comparisons. How many there are depends on Lua's own
// order, which differs from run to run.
static void spend_order(lua_State *L, lua_Integer n)
{
	unsigned levels = 0;
	while (((lua_Integer)1 << levels) < n)
		levels++;
	for (lua_Integer i = 1; i <= n; i++) {
		lua_rawgeti(L, 2, i);
		ob_sandbox_spend(L, levels * (8 + (unsigned)string_bytes(L, -1) / 256));
		lua_pop(L, 1);
	}
}

// Upvalue 1: table.sort
static int sorted_pairs(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	lua_settop(L, 1);
	ob_sandbox_spend_search(L);
	lua_newtable(L);
	lua_Integer n = 0;
	lua_pushnil(L);
	while (lua_next(L, 1)) {
		ob_sandbox_spend(L, 6);
		lua_pop(L, 1);
		int type = lua_type(L, -1);
		if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
			ob_sandbox_fail(L, "pairs: expected keys with an order (numbers, strings), got a %s",
					lua_typename(L, type));
		lua_pushvalue(L, -1);
		lua_rawseti(L, 2, ++n);
	}
	spend_order(L, n);
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_pushvalue(L, 2);
	lua_pushcfunction(L, key_less);
	lua_call(L, 2, 0);
	lua_pushinteger(L, 0);
	lua_pushcclosure(L, next_pair, 3);
	return 1;
}

// Lua's own iterator would read a long text as a number in each call.
static int next_of_list(lua_State *L)
{
	luaL_checktype(L, 2, LUA_TNUMBER);
	ob_sandbox_spend(L, ITERATION);
	const lua_Integer i = luaL_checkinteger(L, 2) + 1;
	lua_pushinteger(L, i);
	return lua_geti(L, 1, i) == LUA_TNIL ? 1 : 2;
}

static int list_pairs(lua_State *L)
{
	luaL_checkany(L, 1);
	lua_pushcfunction(L, next_of_list);
	lua_pushvalue(L, 1);
	lua_pushinteger(L, 0);
	return 3;
}

// ---- no addresses: where things lie in memory differs from run to run, and a scene could compute with it

// Pushes the result of tostring: for a table or a function only the name of its type.
static const char *push_text(lua_State *L, int index, size_t *size)
{
	switch (lua_type(L, index)) {
	case LUA_TNIL:
	case LUA_TBOOLEAN:
	case LUA_TNUMBER:
	case LUA_TSTRING:
		return luaL_tolstring(L, index, size);
	case LUA_TUSERDATA: // an object, in scripts
		if (luaL_callmeta(L, index, "__tostring"))
			return lua_tolstring(L, -1, size);
		__attribute__((fallthrough));
	default:
		lua_pushstring(L, luaL_typename(L, index));
		return lua_tolstring(L, -1, size);
	}
}

static int to_string(lua_State *L)
{
	luaL_checkany(L, 1);
	push_text(L, 1, NULL);
	return 1;
}

// string.format, which gets texts in place of tables and functions. A width or precision is below 100, but all digits
// of a large number may be asked for.
static double charge_format(lua_State *L)
{
	size_t size;
	const char *format = luaL_checklstring(L, 1, &size);
	double units = charge_arguments(L);
	for (size_t i = 0; i + 1 < size; i++) {
		if (format[i] != '%')
			continue;
		i += 1 + strspn(format + i + 1, "-+ #0123456789.");
		if (format[i] == 'p')
			ob_sandbox_fail(L, "string.format: %%p is an address, and not available in scenes");
		units += format[i] && strchr("aAeEfFgGq", format[i]) ? 8 * NUMBER_TEXT : NUMBER_TEXT;
	}
	for (int i = 2, top = lua_gettop(L); i <= top; i++) {
		int type = lua_type(L, i);
		units += 4 * string_bytes(L, i); // of %q
		if (type == LUA_TTABLE || type == LUA_TFUNCTION) {
			push_text(L, i, NULL);
			lua_replace(L, i);
		}
	}
	return units;
}

// print: a note on standard error, apart from the run's output.
static int print(lua_State *L)
{
	char line[1000];
	size_t n = 0;
	line[0] = 0;
	for (int i = 1, top = lua_gettop(L); i <= top && n < sizeof line; i++) {
		n += (size_t)snprintf(line + n, sizeof line - n, "%s%s", i > 1 ? " " : "", push_text(L, i, NULL));
		lua_pop(L, 1);
	}
	ob_log_note("%s", line);
	ob_sandbox_spend(L, PRINT_COST + (unsigned)charge_arguments(L));
	return 0;
}

static const offered base_offered[] = {
	{ "assert", charge_values },
	{ "error", NULL },
	{ "ipairs", NULL },
	{ "select", charge_arguments },
	{ "tonumber", charge_digits },
	{ "tostring", charge_tostring },
	{ "type", charge_values },
	{ NULL, NULL },
};
static const offered math_offered[] = {
	{ "abs", charge_arguments },
	{ "acos", charge_arguments },
	{ "asin", charge_arguments },
	{ "atan", charge_arguments },
	{ "ceil", charge_arguments },
	{ "cos", charge_arguments },
	{ "deg", charge_arguments },
	{ "exp", charge_arguments },
	{ "floor", charge_arguments },
	{ "fmod", charge_arguments },
	{ "huge", NULL },
	{ "log", charge_arguments },
	{ "max", charge_arguments },
	{ "maxinteger", NULL },
	{ "min", charge_arguments },
	{ "mininteger", NULL },
	{ "modf", charge_arguments },
	{ "pi", NULL },
	{ "rad", charge_arguments },
	{ "sin", charge_arguments },
	{ "sqrt", charge_arguments },
	{ "tan", charge_arguments },
	{ "tointeger", charge_arguments },
	{ "type", charge_values },
	{ "ult", charge_arguments },
	{ NULL, NULL },
};
static const offered string_offered[] = {
	{ "byte", charge_byte },       { "char", charge_arguments },
	{ "find", charge_matching },   { "format", charge_format },
	{ "gmatch", charge_matching }, { "gsub", charge_gsub },
	{ "len", charge_others },      { "lower", charge_copy },
	{ "match", charge_matching },  { "rep", charge_rep },
	{ "reverse", charge_copy },    { "sub", charge_others },
	{ "upper", charge_copy },      { NULL, NULL },
};
static const offered table_offered[] = {
	{ "concat", charge_concat },
	{ "insert", charge_insert },
	{ "pack", charge_values },
	{ "remove", charge_shift },
	{ "sort", charge_sort },
	{ "unpack", charge_unpack },
	{ NULL, NULL },
};
// Arithmetic with text, which is read as a number.
static const offered text_arithmetic[] = {
	{ "__add", charge_digits },  { "__sub", charge_digits }, { "__mul", charge_digits },
	{ "__mod", charge_digits },  { "__pow", charge_digits }, { "__div", charge_digits },
	{ "__idiv", charge_digits }, { "__unm", charge_digits }, { NULL, NULL },
};

// Concepts of other simulators that obsim lacks, and what comes nearest.
static const char *const foreign[][2] = {
	{ "joint", "joints are ball, hinge, slider, fixed, universal and distance" },
	{ "revolute", "a joint that turns about an axis is a hinge" },
	{ "prismatic", "a joint that slides along an axis is a slider" },
	{ "weld", "a joint that holds two objects as one is fixed" },
	{ "motor", "a motor is a field of a joint: hinge { ..., motor = { rate = 5 } }" },
	{ "constraint", "joints are ball, hinge, slider, fixed, universal and distance" },
	{ "spring", "a spring is two fields of a joint: distance { ..., stiffness = 100, damping = 5 }" },
	{ "rope", "a rope without a mass is distance { ..., high = 2 }; one with a mass, capsules that balls join" },
	{ "cloth", "obsim has no cloth: its objects are rigid" },
	{ "fluid", "obsim has no fluids: its objects are rigid" },
	{ "cone", "obsim has no cones: hull { points = ... } makes one of its points" },
	{ "ellipsoid", "obsim has no ellipsoids: hull { points = ... } comes near one" },
	{ "torus", "obsim has no tori: compound { parts = ... } of capsules comes near one" },
	{ "terrain", "terrain is a heightfield { ... }, or a mesh { ... }" },
	{ "trimesh", "triangles of a file are a mesh { ... }, which stands still" },
	{ "light", "obsim has no lights: sun { ... } says where light comes from" },
};

static _Noreturn void fail_foreign(lua_State *L, const char *name)
{
	const size_t n = strlen(name);
	for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++) {
		const size_t known = strlen(foreign[i][0]);
		if (strncmp(name, foreign[i][0], known) == 0 && (n == known || (n == known + 1 && name[known] == 's')))
			ob_sandbox_fail(L, "%s: unknown name: %s", name, foreign[i][1]);
	}
	ob_sandbox_fail(L, "%.60s: unknown name", name);
}

// A word of Lua itself: those are learnt elsewhere, and near to words that mean something else here.
static bool is_of_lua(const char *name)
{
	for (const offered *o = base_offered; o->name; o++)
		if (strcmp(o->name, name) == 0)
			return true;
	static const char *const others[] = { "math", "string", "table", "pairs", "print" };
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (strcmp(others[i], name) == 0)
			return true;
	return false;
}

// Reading a global that does not exist.
static int unknown_global(lua_State *L)
{
	const char *name = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "?";
	for (size_t i = 0; withheld[i]; i++)
		if (strcmp(name, withheld[i]) == 0)
			ob_sandbox_fail(
				L, "%s: not available in scenes, which reach no files, no system and no other code",
				name);
	ob_spelling spelling = ob_spelling_start(name);
	spelling.distance = strlen(name) > 5 ? 3 : 2; // a replaced letter makes another word of the short ones
	lua_pushnil(L);
	while (lua_next(L, 1)) {
		if (lua_type(L, -2) == LUA_TSTRING && !is_of_lua(lua_tostring(L, -2)))
			ob_text_offer(&spelling, lua_tostring(L, -2));
		lua_pop(L, 1);
	}
	if (spelling.best)
		ob_sandbox_fail(L, "%.60s: unknown name, did you mean %s?", name, spelling.best);
	fail_foreign(L, name);
}

// Puts the named fields of the table at the top, charged, into the table below it.
static void offer(lua_State *L, const offered *o)
{
	for (; o->name; o++) {
		lua_getfield(L, -1, o->name);
		if (o->charge)
			put_charge(L, o);
		lua_setfield(L, -3, o->name);
	}
}

// A new table with these fields of the one at the top takes its place.
static void keep(lua_State *L, const offered *o)
{
	lua_newtable(L);
	lua_insert(L, -2);
	offer(L, o);
	lua_pop(L, 1);
}

static void open_string(lua_State *L)
{
	luaL_requiref(L, "string", luaopen_string, 0);
	keep(L, string_offered);
	lua_getfield(L, -1, "gmatch");
	lua_pushcclosure(L, gmatch_once, 1);
	lua_setfield(L, -2, "gmatch");
	// Methods of strings, as in s:rep(3), must find the same functions.
	lua_pushliteral(L, "");
	lua_getmetatable(L, -1);
	lua_pushvalue(L, -1);
	offer(L, text_arithmetic);
	lua_pop(L, 1);
	lua_pushvalue(L, -3);
	lua_setfield(L, -2, "__index");
	lua_pop(L, 2);
}

int ob_library_open(lua_State *L)
{
	luaL_requiref(L, "_G", luaopen_base, 0);
	lua_pushcfunction(L, to_string);
	lua_setfield(L, -2, "tostring");
	lua_pushcfunction(L, list_pairs);
	lua_setfield(L, -2, "ipairs");
	keep(L, base_offered);
	lua_pushcfunction(L, print);
	lua_setfield(L, -2, "print");
	luaL_requiref(L, "math", luaopen_math, 0);
	keep(L, math_offered);
	lua_setfield(L, -2, "math");
	open_string(L);
	lua_setfield(L, -2, "string");
	luaL_requiref(L, "table", luaopen_table, 0);
	lua_getfield(L, -1, "sort");
	lua_pushcclosure(L, sorted_pairs, 1);
	lua_setfield(L, -3, "pairs");
	keep(L, table_offered);
	lua_setfield(L, -2, "table");
	lua_newtable(L);
	lua_pushcfunction(L, unknown_global);
	lua_setfield(L, -2, "__index");
	lua_setmetatable(L, -2);
	lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
	return 0;
}
