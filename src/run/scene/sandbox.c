#undef _FORTIFY_SOURCE // snprintf is defined below
#include "scene/sandbox.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <lauxlib.h>

#include "base/clock.h"

// Lua shortens long file names in its messages, so it gets this one, and the path is put in its place at the end.
#define CHUNK "scene"
// A few long operations between two looks at the clock, each below some milliseconds: well under a second together.
#define HOOK_EVERY 100
#define BYTES_MADE 4 // bytes of a new string per instruction; they may be digits of numbers
#define BYTES_COMPARED 256 // bytes of two strings per instruction
#define SHORT_STRING 80 // bytes of a block, for a string that Lua may keep once for all its users, made or not
#define SMALL_TABLE 256 // bytes of a block
#define COLLECTED_BYTES 64 // bytes of memory per instruction of a garbage collection
#define SEARCHED_BYTES 1024 // bytes of a table, empty or not, per instruction of a walk through it
#define TABLE_BYTES 64 // bytes of a new table per instruction
#define BITS_DIVIDED 32 // between two numbers, that count as an instruction of their remainder
#define DIGITS 16 // instructions, to write a number as text
#define VALUES_MOST 255 // of "..." in a function of a script: each instruction may copy all
#define VALUES_COPIED 16 // per instruction
#define LARGE ((size_t)64 << 10) // bytes: filling such a block takes long enough to look at the clock

typedef struct ob_sandbox_sizes {
	size_t longest[2]; // bytes of the two longest strings
	size_t table; // bytes of the largest new block that may be a table
} ob_sandbox_sizes;

struct ob_sandbox {
	lua_State *L;
	const char *path;
	void *user;
	ob_sandbox_limits limit;
	size_t memory; // bytes held by Lua
	uint64_t instructions;
	double begun; // s, of ob_clock_thread_cpu
	double deadline; // s, of ob_clock_wall: until then the time cannot be up
	// Why and where memory was refused last: Lua itself reports no place for it.
	const char *refused;
	int refused_line;
	int error_line;
	bool lacked_memory;
	bool collects; // it may, for want of memory
	bool exhausted; // it may not, and had to: refused until the call ends
	const void *refused_for; // the block that was refused last, for which Lua collects garbage and asks again
	size_t refused_size;
	ob_sandbox_sizes outside, made; // by the text that was read; and with what the call has made
};

// The sandbox that runs in this thread, for strcoll.
static _Thread_local ob_sandbox *running;

static ob_sandbox *sandbox_of(lua_State *L)
{
	return *(ob_sandbox **)lua_getextraspace(L);
}

void *ob_sandbox_user(lua_State *L)
{
	void *user = sandbox_of(L)->user;
	if (!user)
		ob_sandbox_fail(L,
				"this is called while a scene is read, not afterwards: call it outside the function");
	return user;
}

void ob_sandbox_release_user(ob_sandbox *s)
{
	s->user = NULL;
}

int ob_sandbox_line(lua_State *L)
{
	lua_Debug d;
	for (int level = 0; lua_getstack(L, level, &d); level++) {
		lua_getinfo(L, "Sl", &d);
		if (d.currentline > 0 && strcmp(d.source, "=" CHUNK) == 0) // not of a library
			return d.currentline;
	}
	return 0;
}

void ob_sandbox_fail(lua_State *L, const char *format, ...)
{
	char text[sizeof((ob_error *)0)->text];
	const int line = ob_sandbox_line(L); // 0: nothing of the text runs
	int n = snprintf(text, sizeof text, line ? CHUNK ":%d: " : CHUNK ": ", line);
	va_list args;
	va_start(args, format);
	vsnprintf(text + n, sizeof text - (size_t)n, format, args);
	va_end(args);
	lua_pushstring(L, text);
	lua_error(L);
	abort(); // lua_error does not return, but is not declared so
}

void ob_sandbox_extend(lua_State *L, unsigned instructions)
{
	sandbox_of(L)->limit.instructions += instructions;
}

#define TEXT_OF(number) #number
#define SECONDS_TEXT(number) TEXT_OF(number)
static const char too_late[] =
	"stopped after " SECONDS_TEXT(OB_BUDGET_SECONDS) " s of CPU time: does it compute too much?";

// True if the thread's CPU time is up. The clock is looked at first, as it costs a tenth.
static bool is_late(ob_sandbox *s)
{
	const double now = s->deadline < INFINITY ? ob_clock_wall() : 0;
	if (now <= s->deadline)
		return false;
	const double left = s->limit.seconds - (ob_clock_thread_cpu() - s->begun);
	s->deadline = now + left;
	return left <= 0;
}

static void hook(lua_State *L, lua_Debug *d);

// The same where no error can be raised: the next instruction does it.
static void spend_silently(ob_sandbox *s, size_t instructions)
{
	const bool was_within = s->instructions <= s->limit.instructions;
	s->instructions += instructions;
	if (was_within && s->instructions > s->limit.instructions && s->L && lua_gethook(s->L))
		lua_sethook(s->L, hook, LUA_MASKCOUNT, 1);
}

void ob_sandbox_spend(lua_State *L, unsigned instructions)
{
	enum { CLOCK_EVERY = 64 }; // instructions: a look at the clock costs as much as several
	ob_sandbox *s = sandbox_of(L);
	s->instructions += instructions;
	if (s->instructions > s->limit.instructions)
		ob_sandbox_fail(L, "%s", s->limit.out_of_instructions);
	if (s->instructions % CLOCK_EVERY < instructions && is_late(s))
		ob_sandbox_fail(L, "%s", too_late);
}

size_t ob_sandbox_string_max(lua_State *L)
{
	return sandbox_of(L)->limit.string;
}

const char *ob_sandbox_out_of_string(lua_State *L)
{
	return sandbox_of(L)->limit.out_of_string;
}

// True if the function that is called has so many values in "...".
static bool has_values(lua_State *L, const lua_Debug *d, int n)
{
	if (!lua_getlocal(L, d, -n))
		return false;
	lua_pop(L, 1);
	return true;
}

// Counts values that a call passes on as "...", or returns.
static void count_values(lua_State *L, lua_Debug *d)
{
	int n = 0;
	if (d->event == LUA_HOOKRET)
		n = lua_getinfo(L, "r", d) ? d->ntransfer : 0;
	else
		while (n <= VALUES_MOST && has_values(L, d, n + VALUES_COPIED))
			n += VALUES_COPIED;
	if (n > VALUES_MOST && d->event != LUA_HOOKRET)
		ob_sandbox_fail(L, "a function got more than %d values as ...", VALUES_MOST);
	if (n >= VALUES_COPIED)
		ob_sandbox_spend(L, (unsigned)n / VALUES_COPIED);
}

// Any instruction may compare two strings of the same length, which nothing announces: each counts as if it did, with
// the longest that there may be two of. A clock does as well where there is one.
static void hook(lua_State *L, lua_Debug *d)
{
	const ob_sandbox *s = sandbox_of(L);
	const size_t compared = s->deadline < INFINITY ? 0 : s->made.longest[1] / BYTES_COMPARED;
	if (d->event == LUA_HOOKCOUNT)
		ob_sandbox_spend(L, HOOK_EVERY * (1 + (unsigned)compared));
	else
		count_values(L, d);
}

// Lua's order of strings, piece by piece between zero bytes: by bytes in any locale, and counted.
__attribute__((visibility("default"))) int strcoll(const char *a, const char *b)
{
	if (running && *a == *b)
		spend_silently(running, 1 + strlen(a) / BYTES_COMPARED);
	return strcmp(a, b);
}

// Writes numbers as text in Lua: "a" .. 1 is one instruction, with no other call in it.
static int print_counted(char *out, size_t size, const char *format, va_list args)
{
	if (running && (strcmp(format, LUA_INTEGER_FMT) == 0 || strcmp(format, LUA_NUMBER_FMT) == 0))
		spend_silently(running, DIGITS);
	return vsnprintf(out, size, format, args);
}

__attribute__((visibility("default"))) int snprintf(char *out, size_t size, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	const int n = print_counted(out, size, format, args);
	va_end(args);
	return n;
}

// The same as libraries call it that were built with checks of buffers.
int __snprintf_chk(char *out, size_t size, int flag, size_t room, const char *format, ...);
__attribute__((visibility("default"))) int __snprintf_chk(char *out, size_t size, int flag, size_t room,
							  const char *format, ...)
{
	if (size > room)
		abort();
	va_list args;
	va_start(args, format);
	const int n = print_counted(out, size, format, args);
	va_end(args);
	return n;
}

// Clocks by which table.sort chooses some pivots: in Lua, the order of equal values and the count depend on none.
__attribute__((visibility("default"))) clock_t clock(void)
{
	return running ? 0 : (clock_t)(ob_clock_process_cpu() * CLOCKS_PER_SEC);
}

__attribute__((visibility("default"))) time_t time(time_t *out)
{
	struct timespec t = { 0 };
	if (!running)
		clock_gettime(CLOCK_REALTIME, &t);
	if (out)
		*out = t.tv_sec;
	return t.tv_sec;
}

// The exact remainder, called by its address: clang replaces fmodl of two doubles by fmod, which is defined below.
static long double (*const volatile exact_remainder)(long double, long double) = fmodl;

// The remainder in Lua, a % b: long work where one is huge and the other tiny. It is exact with any precision.
__attribute__((visibility("default"))) double fmod(double a, double b)
{
	if (running && isfinite(a) && b != 0 && fabs(a) > fabs(b))
		spend_silently(running, (size_t)(ilogb(a) - ilogb(b)) / BITS_DIVIDED);
	return (double)exact_remainder(a, b);
}

void ob_sandbox_spend_search(lua_State *L)
{
	ob_sandbox_spend(L, (unsigned)(sandbox_of(L)->made.table / SEARCHED_BYTES));
}

// Asking for the line allocates nothing, so it may be done inside the allocator.
static void *refuse(ob_sandbox *s, const char *why)
{
	s->refused = why;
	s->refused_line = s->L ? ob_sandbox_line(s->L) : 0;
	return NULL;
}

// Lua asks twice, and has collected all garbage in between: a second time for the same counts as that work. In a
// sandbox that has run before, garbage depends on what it has run, so there it is no second time.
static void *refuse_for_memory(ob_sandbox *s, const void *block, size_t size)
{
	const bool again = s->refused_size == size && s->refused_for == block;
	s->refused_for = block;
	s->refused_size = again ? 0 : size;
	s->exhausted |= !s->collects;
	if (!again)
		spend_silently(s, s->limit.memory / COLLECTED_BYTES);
	return refuse(s, s->limit.out_of_memory);
}

// Short strings are made or found, depending on what was there before, so they count as nothing but their instruction.
static void count_string(ob_sandbox *s, size_t size)
{
	if (size <= SHORT_STRING)
		return;
	spend_silently(s, size / BYTES_MADE);
	size_t *longest = s->made.longest;
	if (size > longest[0])
		longest[1] = longest[0], longest[0] = size;
	else if (size > longest[1])
		longest[1] = size;
}

// Smaller blocks may be Lua's own, which it has from earlier calls or makes now.
static void count_table(ob_sandbox *s, size_t size)
{
	if (size <= SMALL_TABLE)
		return;
	spend_silently(s, size / TABLE_BYTES);
	if (size > s->made.table)
		s->made.table = size;
}

// lua_Alloc. For a new block, old says what kind of thing it is for.
static void *allocate(void *user, void *block, size_t old, size_t size)
{
	ob_sandbox *s = user;
	size_t had = block ? old : 0;
	if (size == 0) {
		free(block);
		s->memory -= had;
		return NULL;
	}
	const bool string = !block && old == LUA_TSTRING;
	if (size > had) {
		if (string && size > s->limit.string)
			return refuse(s, s->limit.out_of_string);
		if (s->exhausted || s->memory - had + size > s->limit.memory)
			return refuse_for_memory(s, block, size);
		if (size > LARGE && is_late(s))
			return refuse(s, too_late);
	}
	void *moved = realloc(block, size);
	if (moved)
		s->memory += size - had;
	else if (size > had)
		return refuse(s, "no memory left on this machine");
	if (!block && (old == LUA_TTABLE || old == LUA_TFUNCTION || old == LUA_TUSERDATA))
		spend_silently(s, 1); // and its collection
	if (string)
		count_string(s, size);
	else if (!block)
		count_table(s, size);
	return moved ? moved : block; // Lua relies on shrinking, which then costs nothing but room
}

// Message handler: notes where it went wrong, for messages that do not say so.
static int note_line(lua_State *L)
{
	sandbox_of(L)->error_line = ob_sandbox_line(L);
	if (lua_type(L, 1) != LUA_TSTRING)
		lua_pushfstring(L, "error raised with a %s in place of a message", luaL_typename(L, 1));
	return 1;
}

static bool report(ob_sandbox *s, int status, ob_error *e)
{
	size_t n = strlen(CHUNK ":");
	const char *text = lua_tostring(s->L, -1);
	s->lacked_memory = status == LUA_ERRMEM;
	if (status == LUA_ERRMEM)
		ob_fail(e, "%s:%d: %s", s->path, s->refused_line, s->refused);
	else if (strncmp(text, CHUNK ":", n) == 0)
		ob_fail(e, "%s:%s", s->path, text + n);
	else
		ob_fail(e, "%s:%d: %s", s->path, s->error_line, text);
	lua_settop(s->L, 0);
	return false;
}

ob_sandbox *ob_sandbox_create(const char *path, lua_CFunction open, void *user, ob_error *e)
{
	static const ob_sandbox_limits of_scenes = {
		.memory = OB_SANDBOX_MEMORY,
		.string = OB_SANDBOX_STRING,
		.instructions = OB_SANDBOX_INSTRUCTIONS,
		.seconds = OB_BUDGET_SECONDS,
		.out_of_memory = "the scene needs more than 64 MiB of memory",
		.out_of_string = "a string grew beyond 1 MiB",
		.out_of_instructions = "stopped after 50 million instructions: does a loop never end?",
	};
	_Static_assert(OB_SANDBOX_MEMORY == (size_t)64 << 20 && OB_SANDBOX_INSTRUCTIONS == 50000000, "said above");
	return ob_sandbox_create_limited(path, &of_scenes, open, user, e);
}

ob_sandbox *ob_sandbox_create_limited(const char *path, const ob_sandbox_limits *limits, lua_CFunction open, void *user,
				      ob_error *e)
{
	ob_sandbox *s = calloc(1, sizeof *s);
	if (!s)
		return ob_fail(e, "%s: no memory", path), NULL;
	s->path = path;
	s->user = user;
	s->collects = true;
	s->limit = *limits;
	s->begun = ob_clock_thread_cpu();
	s->deadline = limits->seconds < INFINITY ? ob_clock_wall() + limits->seconds : INFINITY;
	s->L = lua_newstate(allocate, s);
	if (!s->L) {
		free(s);
		return ob_fail(e, "%s: no memory", path), NULL;
	}
	*(ob_sandbox **)lua_getextraspace(s->L) = s;
	lua_pushcfunction(s->L, open);
	int status = lua_pcall(s->L, 0, 0, 0);
	if (status != LUA_OK) {
		report(s, status, e);
		ob_sandbox_destroy(s);
		return NULL;
	}
	return s;
}

void ob_sandbox_destroy(ob_sandbox *s)
{
	if (!s)
		return;
	lua_close(s->L);
	free(s);
}

typedef struct offer_args {
	const char *library, *name;
	lua_CFunction f;
} offer_args;

// Called protected, for memory may run out.
static int offer(lua_State *L)
{
	const offer_args *a = lua_touserdata(L, 1);
	lua_pushglobaltable(L);
	if (a->library)
		lua_getfield(L, -1, a->library);
	lua_pushcfunction(L, a->f);
	lua_setfield(L, -2, a->name);
	return 0;
}

bool ob_sandbox_offer(ob_sandbox *s, const char *library, const char *name, lua_CFunction f, ob_error *e)
{
	offer_args a = { library, name, f };
	lua_pushcfunction(s->L, offer);
	lua_pushlightuserdata(s->L, &a);
	int status = lua_pcall(s->L, 1, 0, 0);
	return status == LUA_OK || report(s, status, e);
}

static int call_counted(ob_sandbox *s, int arguments, int handler)
{
	ob_sandbox *const before = running;
	running = s;
	const int calls = s->deadline < INFINITY ? 0 : LUA_MASKCALL | LUA_MASKRET;
	lua_sethook(s->L, hook, calls | LUA_MASKCOUNT, HOOK_EVERY); // which begins to count anew
	const int status = lua_pcall(s->L, arguments, 0, handler);
	lua_sethook(s->L, NULL, 0, 0);
	running = before;
	return status;
}

bool ob_sandbox_run(ob_sandbox *s, const char *text, size_t size, ob_error *e)
{
	if (size && text[0] == LUA_SIGNATURE[0])
		return ob_fail(e, "%s:1: expected Lua text, got compiled Lua", s->path);
	lua_pushcfunction(s->L, note_line);
	int status = luaL_loadbufferx(s->L, text, size, "=" CHUNK, "t");
	if (status == LUA_OK)
		status = call_counted(s, 0, 1);
	s->outside = s->made;
	if (status != LUA_OK)
		return report(s, status, e);
	lua_settop(s->L, 0);
	return true;
}

lua_State *ob_sandbox_lua(ob_sandbox *s)
{
	return s->L;
}

bool ob_sandbox_call(ob_sandbox *s, int arguments, ob_error *e)
{
	lua_State *L = s->L;
	const int handler = lua_gettop(L) - arguments;
	lua_pushcfunction(L, note_line);
	lua_insert(L, handler);
	s->instructions = 0;
	s->begun = ob_clock_thread_cpu();
	s->deadline = s->limit.seconds < INFINITY ? ob_clock_wall() + s->limit.seconds : INFINITY;
	s->exhausted = false;
	s->made = s->outside;
	const int status = call_counted(s, arguments, handler);
	if (status != LUA_OK)
		return report(s, status, e);
	lua_settop(L, 0);
	return true;
}

void ob_sandbox_limit_instructions(ob_sandbox *s, uint64_t instructions)
{
	s->limit.instructions = instructions;
}

void ob_sandbox_forbid_collection(ob_sandbox *s)
{
	s->collects = false;
}

bool ob_sandbox_lacked_memory(const ob_sandbox *s)
{
	return s->lacked_memory;
}

uint64_t ob_sandbox_instructions(const ob_sandbox *s)
{
	return s->instructions;
}
