// Functions available to scenes work and give the same results each time; long-running C functions are stopped in time;
// several threads may load at once.
#include <pthread.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "check.h"
#include "scene/sandbox.h"
#include "text.h"

static const char useful[] =
	"local s = ('a,b,c'):gsub(',', ';') assert(s == 'a;b;c')\n"
	"local t = {} for w in ('one two'):gmatch('%a+') do t[#t + 1] = w end assert(#t == 2 and t[2] == 'two')\n"
	"assert(('n=42'):match('n=(%d+)') == '42' and ('xyx'):find('y', 1, true) == 2)\n"
	"assert(('ab'):rep(3, '-') == 'ab-ab-ab' and (''):rep(5) == '' and ('x'):rep(0) == '' and ('x'):rep(-1) == "
	"'')\n"
	"local u = { 3, 1, 2 } table.sort(u) assert(table.concat(u) == '123')\n"
	"table.sort(u, function(a, b) return a > b end) assert(table.concat(u) == '321')\n"
	"assert(select('#', table.unpack({ 1, 2, 3 })) == 3 and math.max(1, 2) == 2 and #string.format('%5.2f', 1) == "
	"5)\n"
	"for i, v in ipairs(u) do assert(v == 4 - i) end\n"
	"print('a note', 1, nil, {})\n"
	"assert(tostring({}) == 'table' and tostring(print) == 'function' and tostring(nil) == 'nil')\n"
	"assert(('%s %d%% %s %5.1s|'):format({}, 3, print, assert) == 'table 3% function     f|')\n"
	"counter = 0 counter = counter + 1 assert(counter == 1)\n"
	"sphere { radius = 1 }";

// Keys in an order of their own, and removal while going through.
static const char order[] =
	"local t = { zeta = 1, alpha = 2, [3] = 3, [1] = 4, [2.5] = 5, [true] = 6, mid = 7, [false] = 8 }\n"
	"local keys = '' for k, v in pairs(t) do keys = keys .. tostring(k) .. ' ' end\n"
	"assert(keys == '1 2.5 3 alpha mid zeta false true ', keys)\n"
	"local n = 0 for k in pairs(t) do t.zeta = nil n = n + 1 end assert(n == 7)\n"
	"for k in pairs({}) do error('empty') end\n"
	"sphere { radius = 1 }";

static void check_good(const char *text)
{
	ob_scene *s = load_good(text);
	CHECK(s);
	ob_scene_free(s);
}

// Each runs long within few instructions of the Lua machine: strings of the size that is allowed, compared many
// times; shifted tables; searches.
static const char *const slow[3] = {
	"local a, t = ('x'):rep(500000), {} for i = 1, 1e6 do t[i] = a end table.sort(t)",
	"local t = {} for i = 1, 1e6 do t[i] = i end while true do table.insert(t, 1, 0) table.remove(t, 1) end",
	"local a, n = ('a'):rep(1500), 0 while true do n = n + (a:find('a*b') or 0) end",
};

static void *load_slow(void *text)
{
	ob_error e = { "" };
	const double begun = ob_clock_thread_cpu();
	const bool stopped = !load_text(text, &e) && strstr(e.text, ":1: stopped after");
	return stopped && ob_clock_thread_cpu() - begun < OB_BUDGET_SECONDS + .5 ? NULL : text;
}

static int wait_long(lua_State *L)
{
	(void)L;
	usleep(600000);
	return 0;
}

// A wait of the thread is not its work: only CPU time is limited, and no object of the scene extends it.
static void check_waiting(void)
{
	static const ob_sandbox_limits limits = {
		.memory = OB_SANDBOX_MEMORY, .string = OB_SANDBOX_STRING, .instructions = UINT64_MAX, .seconds = .5
	};
	ob_error e;
	ob_sandbox *s = ob_sandbox_create_limited("scene.lua", &limits, ob_library_open, NULL, &e);
	CHECK(s && ob_sandbox_offer(s, NULL, "wait", wait_long, &e));
	const char text[] = "wait() for i = 1, 1000 do end", endless[] = "while true do end";
	CHECK(ob_sandbox_run(s, text, sizeof text - 1, &e));
	CHECK(!ob_sandbox_run(s, endless, sizeof endless - 1, &e) && strstr(e.text, "of CPU time"));
	ob_sandbox_destroy(s);
}

static void check_slow(void)
{
	pthread_t thread[3];
	for (int i = 0; i < 3; i++)
		pthread_create(&thread[i], NULL, load_slow, (void *)slow[i]);
	for (int i = 0; i < 3; i++) {
		void *failed = NULL;
		pthread_join(thread[i], &failed);
		CHECK(!failed);
	}
}

static void *load_many(void *failed)
{
	for (int i = 0; i < 50; i++) {
		ob_error e;
		ob_scene *s = load_text(order, &e);
		*(int *)failed += !s;
		ob_scene_free(s);
		*(int *)failed += load_text("sphere { radius = -1 }", &e) != NULL;
	}
	return NULL;
}

static void check_threads(void)
{
	pthread_t thread[3];
	int failed[3] = { 0 };
	for (int i = 0; i < 3; i++)
		pthread_create(&thread[i], NULL, load_many, &failed[i]);
	for (int i = 0; i < 3; i++) {
		pthread_join(thread[i], NULL);
		CHECK(failed[i] == 0);
	}
}

int main(void)
{
	ob_log_set_notes(0);
	check_good(useful);
	for (int i = 0; i < 5; i++)
		check_good(order);
	check_threads();
	check_waiting();
	check_slow();
	return check_end();
}
