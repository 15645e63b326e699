// Calls of functions count for their work. All functions that can be reached in the sandbox are tried, with
// arguments up to the limits, until their instructions are spent: what looks at a long argument is charged by its
// length. Prints the CPU time that a million instructions have taken at most, which is not tested.
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <lauxlib.h>

#include "base/log.h"
#include "check.h"
#include "scene/sandbox.h"

enum { INSTRUCTIONS = 20000, LENGTH = 60000, FUNCTIONS = 200, NAME = 48 };
enum { LONG = 8, TWIN = 21 }; // indices of values: two long texts that differ at their ends

// Second argument, from 1, with which a function looks at a long first one; 0: it passes it on, or looks at a part.
static const struct {
	const char *name;
	int second;
} special[] = {
	{ "assert", 0 },     { "error", 0 },      { "ipairs", 0 },      { "select", 0 },
	{ "type", 0 },       { "math.type", 0 },  { "string.byte", 0 }, { "string.len", 0 },
	{ "string.sub", 0 }, { "table.pack", 0 }, { "tostring", 0 },    { "table.unpack", 0 },
	{ "string.rep", 2 }, { "concat", 2 },     { "less", TWIN },     { "same", TWIN },
};

static const char values[] =
	"local list, gone, texts = {}, {}, {}\n"
	"for i = 1, 60000 do list[i] = i end\n"
	"for i = 1, 20000 do gone['k' .. i] = i end for i = 1, 20000 do gone['k' .. i] = nil end\n"
	"for i = 1, 2000 do texts[i] = 'text ' .. i end\n"
	"value = { false, 1, -1, 1e15, .1, math.mininteger, '', one:rep(60000), 'a-b', 1e308, 1e-300, "
	"'.-(.)%f[b]', '%99.99f', '%q%s', ('%1'):rep(300), list, gone, texts, math.ult, function() return true end, "
	"twin and one:rep(59999) .. 'b' }\n";

static const char loop[] = "function try(n, f, a, b, c)\n"
			   "  local g\n"
			   "  if n == 0 then while true do g = f() calls = calls + 1 end end\n"
			   "  if n == 1 then while true do g = f(a) calls = calls + 1 end end\n"
			   "  if n == 2 then while true do g = f(a, b) calls = calls + 1 end end\n"
			   "  while true do g = f(a, b, c) calls = calls + 1 end\n"
			   "end\n"
			   "function try_its(n, f, a, b, c) local g = f(a, b, c) if type(g) == 'function' then try(n, "
			   "g, a, b, c) end end\n"
			   "function concat(a, b) return a .. b end function less(a, b) return a < b end function "
			   "same(a, b) return a == b end\n"
			   "function remainder(a, b) return a % b end\n"
			   "calls = 0\n";

typedef struct found {
	char name[FUNCTIONS][NAME];
	int reference[FUNCTIONS];
	int count;
	// The slowest of all calls.
	double seconds;
	char slowest[128];
} found;

// one: the character that the long text repeats. twin: there is a second, for which any instruction counts more.
static ob_sandbox *open_sandbox(const char *one, bool twin)
{
	static const ob_sandbox_limits limits = {
		.memory = 4 << 20,
		.string = 64 << 10,
		.instructions = INSTRUCTIONS,
		.seconds = INFINITY,
		.out_of_memory = "memory",
		.out_of_string = "string",
		.out_of_instructions = "spent",
	};
	ob_error e;
	ob_sandbox_limits reading = limits;
	reading.instructions = UINT64_MAX / 2;
	ob_sandbox *s = ob_sandbox_create_limited("budget", &reading, ob_library_open, NULL, &e);
	CHECK(s);
	char text[2000];
	snprintf(text, sizeof text, "local one, twin = '%s', %s %s", one, twin ? "true" : "false", values);
	if (!ob_sandbox_run(s, text, strlen(text), &e) || !ob_sandbox_run(s, loop, sizeof loop - 1, &e)) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	ob_sandbox_limit_instructions(s, INSTRUCTIONS);
	return s;
}

// All functions in the table at the top, and in tables in it.
static void walk(lua_State *L, found *all, const char *prefix)
{
	for (lua_pushnil(L); lua_next(L, -2); lua_pop(L, 1)) {
		char name[NAME];
		if (lua_type(L, -2) != LUA_TSTRING || strcmp(lua_tostring(L, -2), "value") == 0 ||
		    strncmp(lua_tostring(L, -2), "try", 3) == 0)
			continue;
		snprintf(name, sizeof name, "%s%.30s", prefix, lua_tostring(L, -2));
		if (lua_istable(L, -1) && strlen(prefix) < 20) {
			strcat(name, ".");
			walk(L, all, name);
		} else if (lua_isfunction(L, -1) && all->count < FUNCTIONS) {
			int at = all->count++;
			for (; at > 0 && strcmp(all->name[at - 1], name) > 0;
			     at--) { // each sandbox has an order of its own
				memcpy(all->name[at], all->name[at - 1], NAME);
				all->reference[at] = all->reference[at - 1];
			}
			memcpy(all->name[at], name, NAME);
			lua_pushvalue(L, -1);
			all->reference[at] = luaL_ref(L, LUA_REGISTRYINDEX);
		}
	}
}

static void find_all(lua_State *L, found *all)
{
	all->count = 0;
	lua_pushglobaltable(L);
	walk(L, all, "");
	lua_pushliteral(L, "");
	lua_getmetatable(L, -1);
	lua_pushnil(L);
	lua_setfield(L, -2, "__index"); // the library once more
	walk(L, all, "text.");
	lua_getglobal(L, "string");
	lua_setfield(L, -2, "__index");
	lua_settop(L, 0);
}

static bool needs_twin(const char *name)
{
	for (size_t i = 0; i < sizeof special / sizeof *special; i++)
		if (strcmp(special[i].name, name) == 0)
			return special[i].second == TWIN;
	return false;
}

// True if the function has to look at all of the long text.
static bool is_work(const char *name, int n, int first, int second)
{
	for (size_t i = 0; i < sizeof special / sizeof *special; i++)
		if (strcmp(special[i].name, name) == 0)
			return n == 2 && first == LONG && second == special[i].second;
	return n > 0 && first == LONG;
}

static double cpu(void)
{
	struct timespec t;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// CPU seconds per million instructions, calling the function with so many values until it has nothing left.
static double seconds_of(ob_sandbox *s, const found *all, int f, const char *how, int n, const int value[3])
{
	lua_State *L = ob_sandbox_lua(s);
	ob_error e;
	lua_pushinteger(L, 0);
	lua_setglobal(L, "calls");
	lua_getglobal(L, how);
	lua_pushinteger(L, n);
	lua_rawgeti(L, LUA_REGISTRYINDEX, all->reference[f]);
	lua_getglobal(L, "value");
	for (int i = 0; i < 3; i++)
		lua_rawgeti(L, 4, value[i]);
	lua_remove(L, 4);
	const double start = cpu();
	ob_sandbox_call(s, 5, &e);
	return (cpu() - start) * 1e6 / fmax(INSTRUCTIONS, (double)ob_sandbox_instructions(s));
}

// Notes the time of the slowest, the least of three; returns the number of calls.
static double call(ob_sandbox *s, found *all, int f, const char *how, int n, const int value[3])
{
	lua_State *L = ob_sandbox_lua(s);
	double seconds = INFINITY;
	for (int again = 0; again < 3 && seconds > all->seconds; again++)
		seconds = fmin(seconds, seconds_of(s, all, f, how, n, value));
	if (seconds > all->seconds) {
		all->seconds = seconds;
		snprintf(all->slowest, sizeof all->slowest, "%s %s(%d: %d, %d, %d)", how, all->name[f], n, value[0],
			 value[1], value[2]);
	}
	lua_getglobal(L, "calls");
	const double calls = lua_tonumber(L, -1);
	lua_settop(L, 0);
	return calls;
}

static void try_function(found *all, int f)
{
	static const char *const kinds[] = { "a", "\\0", "0" };
	static const int third[] = { 1, LONG };
	double most = 0;
	all->seconds = 0;
	for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; kind++) {
		ob_sandbox *s = open_sandbox(kinds[kind], needs_twin(all->name[f]));
		find_all(ob_sandbox_lua(s), all);
		for (int n = 0; n <= 3; n++)
			for (int a = 1; a <= (n > 0 ? TWIN : 1); a++)
				for (int b = 1; b <= (n > 1 ? TWIN : 1); b++)
					for (size_t c = 0; c < (n > 2 ? sizeof third / sizeof *third : 1); c++) {
						const int value[] = { a, b, third[c] };
						if (kind > 0 && !(n > 0 && a == LONG) && !(n > 1 && b == LONG))
							continue; // as with the first kind
						const double calls = call(s, all, f, "try", n, value);
						call(s, all, f, "try_its", n, value);
						if (is_work(all->name[f], n, a, b))
							most = fmax(most, calls);
					}
		ob_sandbox_destroy(s);
	}
	printf("%8.1f ms  %7.0f calls  %-16s %s\n", 1e3 * all->seconds, most, all->name[f], all->slowest);
	if (most * LENGTH / 64 <= INSTRUCTIONS)
		return;
	fprintf(stderr, "%s: %g calls with %d bytes for %d instructions\n", all->name[f], most, LENGTH, INSTRUCTIONS);
	CHECK(false);
}

// Runs a text in a new sandbox, with so many instructions; returns how many it has taken. e: its error, or nothing.
static uint64_t count(const char *text, uint64_t instructions, ob_error *e)
{
	const ob_sandbox_limits limits = {
		.memory = 4 << 20,
		.string = 64 << 10,
		.instructions = instructions,
		.seconds = INFINITY,
		.out_of_memory = "memory",
		.out_of_string = "string",
		.out_of_instructions = "spent",
	};
	*e = (ob_error){ "" };
	ob_sandbox *s = ob_sandbox_create_limited("budget", &limits, ob_library_open, NULL, e);
	CHECK(s);
	const double start = cpu();
	ob_sandbox_run(s, text, strlen(text), e);
	const uint64_t n = ob_sandbox_instructions(s);
	printf("%8.1f ms  %.90s\n", 1e9 * (cpu() - start) / fmax(1e5, (double)n), text);
	ob_sandbox_destroy(s);
	return n;
}

// Lua's own order of keys differs from sandbox to sandbox, and table.sort looks at clocks: the count does neither.
static void check_same_count(void)
{
	static const char *const texts[] = {
		"local t = {} for i = 1, 3000 do t['key ' .. i] = i end for i = 1, 9 do for k in pairs(t) do end end",
		"local t = {} for i = 1, 300 do t[('x'):rep(i * 9 % 2000) .. i] = i end for k in pairs(t) do end",
		("for j = 1, 9 do local t = {} for i = 1, 9000 do t[i] = 9 + i * 7919 % 9001 end "
		 "t[1], t[4500], t[9000] = 1, 2, 3 table.sort(t) end"),
	};
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		ob_error e;
		const uint64_t first = count(texts[i], UINT64_MAX / 2, &e);
		CHECK(!*e.text);
		for (int again = 0; again < 8; again++)
			CHECK(count(texts[i], UINT64_MAX / 2, &e) == first);
	}
}

// Work of the machine within one instruction counts: each of these is more than a million.
static void check_machine(void)
{
	static const char *const texts[] = {
		"local n for i = 1, 40000 do n = i .. i end",
		"local n for i = 1, 40000 do n = math.mininteger .. '' n = i .. '' end",
		"local n, x = 1, 1.2345678901234e300 for i = 1, 40000 do n = x .. x end",
		"local function r(n) if n > 0 then return 1, r(n - 1) end end for i = 1, 4 do r(3000) end",
		("local t = {} for i = 1, 200 do t[i] = i end local function f(n, ...) if n > 0 then "
		 "return f(n - 1, ...) end end f(70000, table.unpack(t))"),
		"local n for i = 1, 100000 do n = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12 } end",
	};
	static const char *const refused[] = {
		"local t = {} for i = 1, 300 do t[i] = i end local function f(...) end f(table.unpack(t))",
		"local function f(n, ...) if n > 0 then return f(n - 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, ...) end end f(99)",
	};
	ob_error e;
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		count(texts[i], 1000000, &e);
		CHECK(strstr(e.text, "spent"));
	}
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
		count(refused[i], 1000000, &e);
		CHECK(strstr(e.text, "a function got more than 255 values as ..."));
	}
}

int main(void)
{
	check_same_count();
	check_machine();
	static found all;
	ob_log_set_notes(0);
	ob_sandbox *s = open_sandbox("a", false);
	find_all(ob_sandbox_lua(s), &all);
	ob_sandbox_destroy(s);
	CHECK(all.count > 50 && all.count < FUNCTIONS);
	for (int f = 0, n = all.count; f < n; f++)
		try_function(&all, f);
	return check_end();
}
