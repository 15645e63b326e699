#include "cli/top.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <wchar.h>
#include <wctype.h>

#include <ob/motion.h>

#include "base/utf8.h"

enum { LINE_MAX_BYTES = 512, NAME_WIDTH = 12, WORKERS_AT_A_GLANCE = 4, WORKER_HEADING = 2 };

// Prints one line, cut at the screen's width in characters. Only names have any beyond ASCII, in a column of their own
// that is padded by width.
static void put_line(ob_top_view *view, FILE *f, const char *line)
{
	mbstate_t state = { 0 };
	int width = 0;
	if (view->lines > 0 && view->written >= view->lines)
		return;
	view->written++;
	for (const char *at = line; *at;) {
		wchar_t c;
		size_t n = mbrtowc(&c, at, MB_CUR_MAX, &state);
		bool good = n != (size_t)-1 && n != (size_t)-2 && n > 0;
		int cells = good ? wcwidth(c) : 1;
		cells = cells < 0 ? 1 : cells;
		if (view->columns > 0 && width + cells > view->columns)
			break;
		fwrite(at, 1, good ? n : 1, f);
		at += good ? n : 1;
		width += cells;
	}
	fputc('\n', f);
}

// A name for a terminal, cut at max cells, with nothing in it that a terminal would obey. Returns its width.
static int clean_name(const char *name, int max, char *out, size_t size)
{
	mbstate_t state = { 0 };
	size_t used = 0;
	int width = 0;
	for (const char *at = name, *end = name + strnlen(name, OB_NAME_MAX); at < end && used + MB_LEN_MAX < size;) {
		wchar_t c;
		size_t n = mbrtowc(&c, at, (size_t)(end - at), &state);
		bool good = n != (size_t)-1 && n != (size_t)-2 && n > 0;
		if (!good) {
			n = 1;
			state = (mbstate_t){ 0 };
		}
		bool shown = good && iswprint((wint_t)c) && ob_utf8_is_plain((uint32_t)c);
		int cells = shown ? wcwidth(c) : 1;
		if (cells < 0 || width + cells > max)
			break;
		if (shown)
			memcpy(out + used, at, n);
		else
			out[used] = '?';
		used += shown ? n : 1;
		width += cells;
		at += n;
	}
	out[used] = 0;
	return width;
}

static const char *state_name(const ob_top_sample *s)
{
	static const char *const names[] = { "starting", "running", "finished", "failed" };
	if (s->info.state == OB_UNIVERSE_LOST)
		return "lost: another program has cut it short";
	if (!s->alive)
		return s->info.state == OB_UNIVERSE_FINISHED ? "finished, host gone" : "host gone";
	return s->info.state <= OB_UNIVERSE_FAILED ? names[s->info.state] : "?";
}

static void put_header(ob_top_view *view, const ob_top_sample *s, FILE *f)
{
	const ob_universe_info *i = &s->info;
	char line[LINE_MAX_BYTES], name[128], rate[64] = "";
	clean_name(i->name, OB_NAME_MAX, name, sizeof name);
	snprintf(line, sizeof line, "%s: %s, %s in %" PRIu32 " %.8s%s, host %d", name, state_name(s),
		 strncmp(i->arch, "monolith", 8) == 0 ? "monolith" : "object simulators", i->workers, i->isolation,
		 i->workers == 1          ? ""
		 : i->isolation[0] == 't' ? "s"
					  : "es",
		 (int)i->host_pid);
	put_line(view, f, line);
	if (!isnan(s->steps_per_second))
		snprintf(rate, sizeof rate, ", %.1f steps/s, %.3g x real time", s->steps_per_second, s->pace);
	snprintf(line, sizeof line, "step %" PRIu64 ", time %.3f s%s", i->step, i->time, rate);
	put_line(view, f, line);
	snprintf(line, sizeof line, "objects %" PRIu32 ", awake %" PRIu32 ", near pairs %" PRIu32 ", islands %" PRIu32,
		 i->objects, i->awake, i->pairs, i->islands);
	put_line(view, f, line);
	if (i->deaths == 0)
		return;
	int n = snprintf(line, sizeof line, "deaths %" PRIu32, i->deaths);
	if (i->frozen)
		n += snprintf(line + n, sizeof line - (size_t)n, ", objects frozen %" PRIu32, i->frozen);
	snprintf(line + n, sizeof line - (size_t)n, "; the last: %s", i->last_death);
	put_line(view, f, line);
}

static void put_workers(ob_top_view *view, const ob_top_sample *s, uint32_t from, uint32_t count, FILE *f)
{
	char line[LINE_MAX_BYTES], share[16], core[16];
	put_line(view, f, "");
	put_line(view, f, "WORKER       PID       TID  CORE  OBJECTS   CPU %     CPU s");
	for (uint32_t i = from; i < from + count; i++) {
		const ob_top_worker *w = &s->worker[i];
		snprintf(share, sizeof share, isnan(w->share) ? "-" : "%.1f", 100 * w->share);
		snprintf(core, sizeof core, w->info.cpu < 0 ? "-" : "%d", w->info.cpu);
		snprintf(line, sizeof line, "%6" PRIu32 " %9d %9d %5s %8" PRIu32 " %7s %9.2f", i, (int)w->info.pid,
			 (int)w->info.tid, core, w->info.objects, share, 1e-9 * (double)w->info.cpu_ns);
		put_line(view, f, line);
	}
}

// Shows values at the level of rounding errors as 0.
static double tidy(double x)
{
	return fabs(x) < 1e-6 ? 0 : x;
}

static void put_object(ob_top_view *view, const ob_top_object *o, FILE *f)
{
	char line[LINE_MAX_BYTES], name[128];
	int pad = NAME_WIDTH - clean_name(o->passport.name, NAME_WIDTH, name, sizeof name);
	const char *shape = ob_shape_name((ob_shape)o->passport.shape);
	const char *state = o->passport.flags & OB_OBJECT_FROZEN      ? "frozen"
			    : o->passport.flags & OB_OBJECT_STATIC    ? "static"
			    : o->passport.flags & OB_OBJECT_KINEMATIC ? "driven"
			    : !o->moving                              ? "?"
			    : (o->motion.flags & OB_MOTION_ASLEEP)    ? "asleep"
			    : (o->motion.flags & OB_MOTION_FREE)      ? "free"
								      : "awake";
	char home[16] = "-";
	if (o->housed)
		snprintf(home, sizeof home, "%" PRIu32, o->home);
	int n = snprintf(line, sizeof line, "%5" PRIu32 " %s%*s %-8s %-6s %6s", o->id, name, pad, "", shape, state,
			 home);
	if (o->moving)
		snprintf(line + n, sizeof line - (size_t)n, " %8.4g %8.4g %8.4g %8.3g %8.3g", tidy(o->position.x),
			 tidy(o->position.y), tidy(o->position.z), tidy(o->speed), tidy(o->spin));
	n = (int)strlen(line);
	if (o->waits)
		snprintf(line + n, sizeof line - (size_t)n, "  waits for %" PRIu32, o->blocker);
	put_line(view, f, line);
}

static int compare_id(const void *a, const void *b)
{
	uint32_t x = ((const ob_top_object *)a)->id, y = ((const ob_top_object *)b)->id;
	return (x > y) - (x < y);
}

static int compare_speed(const void *a, const void *b)
{
	double x = ((const ob_top_object *)a)->speed, y = ((const ob_top_object *)b)->speed;
	return x != y ? (x < y) - (x > y) : compare_id(a, b);
}

// Number of lines of a list of n that fit below the text so far, minus some; limits the scroll position to it.
static uint32_t fit(ob_top_view *view, uint32_t n, int less)
{
	int room = view->lines - view->written - less;
	uint32_t shown = view->lines == 0 || room > (int64_t)n ? n : room > 0 ? (uint32_t)room : 0;
	if (view->scroll > n - shown)
		view->scroll = n - shown;
	return shown;
}

static void write_objects(ob_top_view *view, ob_top_sample *s, FILE *f)
{
	put_line(view, f, "");
	put_line(view, f, "   ID NAME         SHAPE    STATE  WORKER      X m      Y m      Z m SPEED m/s SPIN r/s");
	uint32_t shown = fit(view, s->objects, 0);
	if (s->objects > 0)
		qsort(s->object, s->objects, sizeof *s->object, view->by_speed ? compare_speed : compare_id);
	for (uint32_t i = 0; i < shown; i++)
		put_object(view, &s->object[view->scroll + i], f);
}

void ob_top_view_write(ob_top_view *view, ob_top_sample *s, FILE *f)
{
	view->written = 0;
	put_header(view, s, f);
	bool all = view->lines == 0;
	if (view->workers && !all) {
		uint32_t shown = fit(view, s->workers, WORKER_HEADING);
		put_workers(view, s, view->scroll, shown, f);
		return;
	}
	uint32_t glance = all || s->workers < WORKERS_AT_A_GLANCE ? s->workers : WORKERS_AT_A_GLANCE;
	put_workers(view, s, 0, glance, f);
	if (glance < s->workers) {
		char line[64];
		snprintf(line, sizeof line, "   ... %" PRIu32 " more: w shows them", s->workers - glance);
		put_line(view, f, line);
	}
	write_objects(view, s, f);
}
