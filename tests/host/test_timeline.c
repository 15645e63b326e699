// The timeline's file: it reports lost events, write errors are errors, and odd names stay valid JSON.
// (tests/run/test_trace.py checks that importers accept the file as a whole.)
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "check.h"
#include "host/timeline.h"
#include "table/layout.h"

static char path[64];

static ob_universe *create(void)
{
	ob_error e = { "" };
	ob_universe_setup setup = { .capacity = 4, .workers = 2, .isolation = "thread", .traced = true };
	ob_universe *u = ob_universe_create(&setup, &e);
	CHECK(u);
	return u;
}

static const char *file_text(void)
{
	static char text[1 << 16];
	FILE *f = fopen(path, "r");
	size_t n = f ? fread(text, 1, sizeof text - 1, f) : 0;
	if (f)
		fclose(f);
	text[n] = 0;
	return text;
}

// Counts the lines of the file with this text: an event has a line.
static uint32_t count(const char *what)
{
	char line[1024];
	uint32_t n = 0;
	FILE *f = fopen(path, "r");
	while (f && fgets(line, sizeof line, f))
		n += strstr(line, what) != NULL;
	if (f)
		fclose(f);
	return n;
}

static void test_lost(void)
{
	ob_universe *u = create();
	ob_error e = { "" };
	ob_timeline_sums sums;
	if (!u)
		return;
	uint32_t size = u->header.sizes.trace_events;
	for (uint32_t i = 0; i < size + 70; i++)
		ob_trace_span(u, 1, OB_TRACE_SCHEDULE, ob_clock_ns(), 0, 0);
	ob_timeline *t = ob_timeline_start(u, path, &e);
	CHECK(t && ob_timeline_finish(t, NULL, 0, &sums, &e));
	CHECK(sums.events == size + 70 && sums.lost == 70);
	CHECK(count("\"name\":\"schedule\"") == size);
	CHECK(count("\"name\":\"events lost\",\"args\":{\"events\":70}") == 1);
	CHECK(count("\"lost\":70}}\n") == 1);
	ob_universe_destroy(u, true);
}

// Inner spans end first, but must stand after the outer one.
static void test_order(void)
{
	ob_universe *u = create();
	ob_error e = { "" };
	ob_timeline_sums sums;
	if (!u)
		return;
	ob_timeline *t = ob_timeline_start(u, path, &e);
	uint64_t now = ob_clock_ns();
	ob_trace_span(u, 0, OB_TRACE_PROFILE, now, OB_PROFILE_LOAD, 0);
	ob_trace_span(u, 0, OB_TRACE_ISLAND, now, 3, 9);
	ob_trace_span(u, 0, OB_TRACE_CHUNK, now, 1, 9);
	ob_trace_span(u, 0, OB_TRACE_SOLVE, now, 1, 9);
	ob_trace_doing(u, 1, OB_TRACE_OBJECTS, now);
	CHECK(t && ob_timeline_finish(t, NULL, 0, &sums, &e) && sums.events == 4 && sums.lost == 0);
	const char *text = file_text();
	const char *solve = strstr(text, "\"solve\""), *chunk = strstr(text, "\"chunk\"");
	const char *island = strstr(text, "\"island\""), *load = strstr(text, "\"load\"");
	CHECK(solve && solve < chunk && chunk < island && island < load);
	CHECK(count("\"name\":\"objects\",\"args\":{\"unfinished\":true}") == 1);
	ob_universe_destroy(u, true);
}

static void test_names(void)
{
	ob_universe *u = create();
	ob_error e = { "" };
	ob_timeline_sums sums;
	ob_passport p = { .id = 2,
			  .flags = OB_OBJECT_PRESENT,
			  .shape = OB_SHAPE_SPHERE,
			  .size = { 1, 0, 0 },
			  .mass = 1,
			  .name = "a\"b\\c\n\xc3\xa4 \xff" };
	if (!u)
		return;
	ob_write_passport(u, 2, &p);
	ob_trace_birth(u, 2);
	ob_timeline *t = ob_timeline_start(u, path, &e);
	CHECK(t && ob_timeline_finish(t, NULL, 0, &sums, &e));
	CHECK(strstr(file_text(), "\"2 a\\u0022b\\u005cc\\u000a\xc3\xa4 \\u00ff\""));
	ob_universe_destroy(u, true);
}

static void test_no_room(void)
{
	ob_universe *u = create();
	ob_error e = { "" };
	ob_timeline_sums sums;
	if (!u)
		return;
	CHECK(!ob_timeline_start(u, "/nowhere/at/all", &e) && strstr(e.text, "/nowhere/at/all"));
	ob_timeline *t = ob_timeline_start(u, "/dev/full", &e);
	CHECK(t && !ob_timeline_finish(t, NULL, 0, &sums, &e) && strstr(e.text, "/dev/full"));
	ob_universe_destroy(u, true);
}

int main(void)
{
	snprintf(path, sizeof path, "/tmp/obsim-test-timeline-%d.json", (int)getpid());
	test_lost();
	test_order();
	test_names();
	test_no_room();
	unlink(path);
	return check_end();
}
