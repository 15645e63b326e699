// What the sandbox offers of Lua's own libraries: a list of what is known to be harmless, guards where one call could
// run without end, and a clear word where a scene asks for something else.
#include <stdio.h>
#include <string.h>

#include <lauxlib.h>
#include <lualib.h>

#include "base/log.h"
#include "base/spelling.h"
#include "scene/sandbox.h"
#include "scene/text.h"

// Steps that one pattern match may take at most: some 50 ms.
#define PATTERN_STEPS 1e7
#define STEPS_PER_INSTRUCTION 100. // of the matcher; a bound of them, mostly far above what it takes
#define PRINT_COST 1000 // instructions that writing a line is worth

static const char *const base_names[] = { "assert", "error", "ipairs", "select", "tonumber", "type", NULL };
static const char *const math_names[] = { "abs", "acos",       "asin", "atan", "ceil", "cos", "deg",
					  "exp", "floor",      "fmod", "huge", "log",  "max", "maxinteger",
					  "min", "mininteger", "modf", "pi",   "rad",  "sin", "sqrt",
					  "tan", "tointeger",  "type", "ult",  NULL };
static const char *const string_names[] = { "byte",  "char",  "find", "format",  "gmatch", "gsub",  "len",
					    "lower", "match", "rep",  "reverse", "sub",    "upper", NULL };
static const char *const table_names[] = { "concat", "insert", "pack", "remove", "unpack", NULL };
static const char *const pattern_names[] = { "find", "gmatch", "gsub", "match", NULL };
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

// string.find and its kin: upvalue 1 is the original. The matcher cannot be interrupted, so what may run long is
// refused before it starts.
static int match_guarded(lua_State *L)
{
	size_t length, size;
	luaL_checklstring(L, 1, &length);
	const char *pattern = luaL_checklstring(L, 2, &size);
	if (pattern_steps(pattern, size, length) > PATTERN_STEPS)
		ob_sandbox_fail(L, "pattern too costly: expected a shorter text or fewer of * + - in the pattern");
	ob_sandbox_spend(L, 1 + (unsigned)(pattern_steps(pattern, size, length) / STEPS_PER_INSTRUCTION));
	return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

// string.rep: the original turns n times even where the text is empty.
static int rep_guarded(lua_State *L)
{
	size_t length, between = 0;
	luaL_checklstring(L, 1, &length);
	lua_Integer n = luaL_checkinteger(L, 2);
	luaL_optlstring(L, 3, "", &between);
	size_t each = length + between > 0 ? length + between : 1;
	if (n > 0 && (double)n * (double)each > (double)OB_SANDBOX_STRING)
		ob_sandbox_fail(L, "string.rep: a string grew beyond 1 MiB");
	return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

static int less(lua_State *L)
{
	ob_sandbox_spend(L, 1);
	lua_pushboolean(L, lua_compare(L, 1, 2, LUA_OPLT));
	return 1;
}

// table.sort: upvalue 1 is the original; without a comparison of the scene's own it would count as one instruction.
static int sort_guarded(lua_State *L)
{
	lua_settop(L, 2);
	if (lua_isnil(L, 2)) {
		lua_pushcfunction(L, less);
		lua_replace(L, 2);
	}
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_insert(L, 1);
	lua_call(L, 2, 0);
	return 0;
}

// pairs(t) goes in a fixed order, numbers before strings before booleans: Lua's own depends on where things lie in memory,
// and differs from run to run.
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

// Bytes, not the collation of some locale.
static bool string_less(lua_State *L)
{
	size_t n, m;
	const char *a = lua_tolstring(L, 1, &n), *b = lua_tolstring(L, 2, &m);
	int order = memcmp(a, b, n < m ? n : m);
	return order < 0 || (order == 0 && n < m);
}

static int key_less(lua_State *L)
{
	ob_sandbox_spend(L, 1);
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

// Upvalue 1: table.sort
static int sorted_pairs(lua_State *L)
{
	luaL_checktype(L, 1, LUA_TTABLE);
	lua_settop(L, 1);
	lua_newtable(L);
	lua_Integer n = 0;
	lua_pushnil(L);
	while (lua_next(L, 1)) {
		lua_pop(L, 1);
		int type = lua_type(L, -1);
		if (type != LUA_TNUMBER && type != LUA_TSTRING && type != LUA_TBOOLEAN)
			ob_sandbox_fail(L, "pairs: expected keys with an order (numbers, strings), got a %s",
					lua_typename(L, type));
		lua_pushvalue(L, -1);
		lua_rawseti(L, 2, ++n);
	}
	lua_pushvalue(L, lua_upvalueindex(1));
	lua_pushvalue(L, 2);
	lua_pushcfunction(L, key_less);
	lua_call(L, 2, 0);
	lua_pushinteger(L, 0);
	lua_pushcclosure(L, next_pair, 3);
	return 1;
}

// ---- no addresses: where things lie in memory differs from run to run, and a scene could compute with it

// Pushes what tostring gives: of a table or a function the name of its type alone.
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

// string.format: upvalue 1 is the original, which gets texts in place of tables and functions.
static int format_guarded(lua_State *L)
{
	size_t size;
	const char *format = luaL_checklstring(L, 1, &size);
	for (size_t i = 0; i + 1 < size; i++) {
		if (format[i] != '%')
			continue;
		i += 1 + strspn(format + i + 1, "-+ #0123456789.");
		if (format[i] == 'p')
			ob_sandbox_fail(L, "string.format: %%p is an address, and not available in scenes");
	}
	for (int i = 2, top = lua_gettop(L); i <= top; i++) {
		int type = lua_type(L, i);
		if (type == LUA_TTABLE || type == LUA_TFUNCTION) {
			push_text(L, i, NULL);
			lua_replace(L, i);
		}
	}
	return lua_tocfunction(L, lua_upvalueindex(1))(L);
}

// print: a note on standard error, where it cannot mix with what the run writes.
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
	ob_sandbox_spend(L, PRINT_COST);
	return 0;
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
	lua_pushnil(L);
	while (lua_next(L, 1)) {
		if (lua_type(L, -2) == LUA_TSTRING)
			ob_text_offer(&spelling, lua_tostring(L, -2));
		lua_pop(L, 1);
	}
	if (spelling.best)
		ob_sandbox_fail(L, "%.60s: unknown name, did you mean %s?", name, spelling.best);
	ob_sandbox_fail(L, "%.60s: unknown name", name);
}

// Copies the named fields of the table at the top into a new table, which takes its place.
static void keep(lua_State *L, const char *const *names)
{
	lua_newtable(L);
	for (; *names; names++) {
		lua_getfield(L, -2, *names);
		lua_setfield(L, -2, *names);
	}
	lua_remove(L, -2);
}

// Puts a guard round a function of the table at the top.
static void guard(lua_State *L, const char *name, lua_CFunction f)
{
	lua_getfield(L, -1, name);
	lua_pushcclosure(L, f, 1);
	lua_setfield(L, -2, name);
}

static void open_string(lua_State *L)
{
	luaL_requiref(L, "string", luaopen_string, 0);
	keep(L, string_names);
	for (size_t i = 0; pattern_names[i]; i++)
		guard(L, pattern_names[i], match_guarded);
	guard(L, "rep", rep_guarded);
	guard(L, "format", format_guarded);
	// Methods of strings, as in s:rep(3), must find the same functions.
	lua_pushliteral(L, "");
	lua_getmetatable(L, -1);
	lua_pushvalue(L, -3);
	lua_setfield(L, -2, "__index");
	lua_pop(L, 2);
}

int ob_library_open(lua_State *L)
{
	luaL_requiref(L, "_G", luaopen_base, 0);
	keep(L, base_names);
	lua_pushcfunction(L, print);
	lua_setfield(L, -2, "print");
	lua_pushcfunction(L, to_string);
	lua_setfield(L, -2, "tostring");
	luaL_requiref(L, "math", luaopen_math, 0);
	keep(L, math_names);
	lua_setfield(L, -2, "math");
	open_string(L);
	lua_setfield(L, -2, "string");
	luaL_requiref(L, "table", luaopen_table, 0);
	lua_getfield(L, -1, "sort");
	lua_pushvalue(L, -1);
	lua_pushcclosure(L, sorted_pairs, 1);
	lua_setfield(L, -4, "pairs");
	lua_insert(L, -2);
	keep(L, table_names);
	lua_insert(L, -2);
	lua_pushcclosure(L, sort_guarded, 1);
	lua_setfield(L, -2, "sort");
	lua_setfield(L, -2, "table");
	lua_newtable(L);
	lua_pushcfunction(L, unknown_global);
	lua_setfield(L, -2, "__index");
	lua_setmetatable(L, -2);
	lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
	return 0;
}
