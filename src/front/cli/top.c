// obsim top: looks into a running universe from outside, as any program that links libobsim can.
#include "cli/top.h"

#include <inttypes.h>
#include <limits.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <wchar.h>
#include <wctype.h>

#include <ob/motion.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/spelling.h"
#include "base/utf8.h"
#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/terminal.h"
#include "table/free.h"
#include "table/table.h"

// ---- top view

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

static void put_sensor(ob_top_view *view, const ob_top_sensor *o, FILE *f)
{
	const ob_sensor_passport *p = &o->passport;
	char line[LINE_MAX_BYTES], name[128], object[16] = "-";
	const int pad = NAME_WIDTH - clean_name(p->name, NAME_WIDTH, name, sizeof name);
	const char *kind = ob_sensor_kind_name(p->kind);
	if (p->kind != OB_SENSOR_ENCODER)
		snprintf(object, sizeof object, "%" PRIu32, p->object);
	int n = snprintf(line, sizeof line, "%s%*s %-12s %6s", name, pad, "", kind ? kind : "?", object);
	if (o->number)
		n += snprintf(line + n, sizeof line - (size_t)n, " %9.4f", o->time);
	if (p->kind == OB_SENSOR_CAMERA)
		snprintf(line + n, sizeof line - (size_t)n, "  picture %" PRIu64 " of %" PRIu32 " x %" PRIu32,
			 o->number, p->beams, p->rows);
	else if (p->kind == OB_SENSOR_LIDAR && o->number)
		snprintf(line + n, sizeof line - (size_t)n, "  nearest %.4g of %" PRIu32, o->value[0], p->width);
	else
		for (uint32_t k = 0; k < p->width && k < sizeof o->value / sizeof *o->value && o->number; k++)
			n += snprintf(line + n, sizeof line - (size_t)n, " %8.4g", tidy(o->value[k]));
	put_line(view, f, line);
}

static void write_sensors(ob_top_view *view, const ob_top_sample *s, FILE *f)
{
	put_line(view, f, "");
	put_line(view, f, "SENSOR       KIND         OBJECT    TIME s  VALUES");
	const uint32_t shown = fit(view, s->sensors, 0);
	for (uint32_t i = 0; i < shown; i++)
		put_sensor(view, &s->sensor[view->scroll + i], f);
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
	if (view->sensors && !all) {
		write_sensors(view, s, f);
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
	if (all && s->sensors)
		write_sensors(view, s, f);
}

// ---- top sample

// Makes room for n records of the given size, the new ones zeroed.
static bool grow(void **records, uint32_t *room, uint32_t n, size_t size)
{
	if (n <= *room)
		return true;
	if (!ob_grow(records, *room, n, size))
		return false;
	*room = n;
	return true;
}

void ob_top_watch(ob_top_sample *s, const ob_universe *u)
{
	double at = ob_clock_wall();
	for (uint32_t i = 0; i < s->workers; i++) {
		ob_top_worker *w = &s->worker[i];
		uint64_t before = w->info.cpu_ns;
		if (!ob_universe_get_worker(u, i, &w->info) || w->info.cpu_ns == before)
			continue;
		if (w->seen_at == 0) {
			w->mark_ns = w->info.cpu_ns;
			w->mark_at = at;
		}
		w->seen_at = at;
	}
}

// The rates since the last marks, which then move up.
static void rate_workers(ob_top_sample *s)
{
	for (uint32_t i = 0; i < s->workers; i++) {
		ob_top_worker *w = &s->worker[i];
		double span = w->seen_at - w->mark_at;
		if (w->seen_at > 0 && span > 0) {
			w->share = 1e-9 * (double)(w->info.cpu_ns - w->mark_ns) / span;
			w->mark_ns = w->info.cpu_ns;
			w->mark_at = w->seen_at;
		} else if (s->at - w->seen_at > 1.5) {
			// no refresh for long: it stands still
			w->share = w->seen_at > 0 ? 0 : NAN;
		}
	}
}

static void look_at_object(ob_top_object *o, const ob_universe *u, uint32_t id, double now)
{
	o->id = id;
	o->housed = ob_universe_get_home(u, id, &o->home);
	o->waits = ob_free_settings_of(u) && ob_free_blocker(u, id, &o->blocker);
	o->moving = ob_universe_get_motion(u, id, &o->motion);
	if (!o->moving)
		return;
	const ob_motion *m = &o->motion;
	double t = fmax(m->t0, fmin(now, m->valid_until));
	ob_state state = ob_motion_at(m, o->passport.inertia, t);
	o->position = state.pose.p;
	o->speed = ob_norm(state.v);
	o->spin = ob_norm(state.w);
}

static bool look_at_objects(ob_top_sample *s, const ob_universe *u)
{
	s->objects = 0;
	for (uint32_t id = 0; id < s->info.capacity; id++) {
		ob_passport p;
		if (!ob_universe_get_passport(u, id, &p))
			continue;
		void *records = s->object;
		if (s->objects == s->object_room &&
		    !grow(&records, &s->object_room, 2 * s->object_room + 64, sizeof *s->object))
			return false;
		s->object = records;
		s->object[s->objects].passport = p;
		look_at_object(&s->object[s->objects++], u, id, s->info.time);
	}
	return true;
}

static bool look_at_workers(ob_top_sample *s, const ob_universe *u)
{
	void *records = s->worker;
	uint32_t known = s->workers;
	bool fine = grow(&records, &s->worker_room, s->info.workers, sizeof *s->worker);
	s->worker = records;
	if (!fine)
		return false;
	s->workers = s->info.workers;
	for (uint32_t i = known; i < s->workers; i++) {
		s->worker[i] = (ob_top_worker){ .share = NAN };
		// its CPU time until now is no refresh that was seen to come
		ob_universe_get_worker(u, i, &s->worker[i].info);
	}
	ob_top_watch(s, u);
	rate_workers(s);
	return true;
}

// Reads the newest sample of each sensor.
static bool look_at_sensors(ob_top_sample *s, const ob_universe *u)
{
	double value[OB_SENSOR_VALUES_MAX];
	void *records = s->sensor;
	const bool fine = grow(&records, &s->sensor_room, ob_universe_sensors(u), sizeof *s->sensor);
	s->sensor = records;
	s->sensors = 0;
	for (uint32_t i = 0; fine && i < s->sensor_room && i < ob_universe_sensors(u); i++) {
		ob_top_sensor *to = &s->sensor[s->sensors];
		const ob_sensor_passport *p = &to->passport;
		*to = (ob_top_sensor){ 0 };
		if (!ob_universe_get_sensor(u, i, &to->passport))
			continue;
		s->sensors++;
		const bool picture = p->kind == OB_SENSOR_CAMERA, lidar = p->kind == OB_SENSOR_LIDAR;
		if (ob_universe_get_samples(u, i, 0, &to->number, &to->time, picture ? NULL : value, 1) == 0)
			continue;
		to->value[0] = lidar ? INFINITY : 0;
		for (uint32_t k = 0; k < p->width && lidar; k++)
			to->value[0] = fmin(to->value[0], value[k]);
		for (uint32_t k = 0; k < p->width && k < sizeof to->value / sizeof *value && !lidar && !picture; k++)
			to->value[k] = value[k];
	}
	return fine;
}

bool ob_top_look(ob_top_sample *s, const ob_universe *u)
{
	double at = ob_clock_wall(), span = at - s->at, time = s->info.time;
	uint64_t step = s->info.step;
	bool first = s->at == 0;
	ob_universe_get_info(u, &s->info);
	s->at = at;
	s->alive = ob_universe_is_hosted(u);
	s->steps_per_second = first ? NAN : (double)(s->info.step - step) / span;
	s->pace = first ? NAN : (s->info.time - time) / span;
	return look_at_workers(s, u) && look_at_objects(s, u) && look_at_sensors(s, u);
}

void ob_top_finish(ob_top_sample *s)
{
	free(s->worker);
	free(s->object);
	free(s->sensor);
	*s = (ob_top_sample){ 0 };
}

// ---- top

enum { NAMES_MAX = 64 };
static const double watch_period = .05; // s, between looks at the workers' clocks

// The universe meant: the one named, or the newest. NULL and *code on failure, which is told.
static ob_universe *attach(const char *name, int *code)
{
	char names[NAMES_MAX][OB_NAME_MAX];
	size_t n = ob_universe_list(names, NAMES_MAX);
	n = n < NAMES_MAX ? n : NAMES_MAX;
	ob_error e;
	*code = OB_EXIT_FAILED;
	if (n == 0) {
		ob_command_fail(*code, "no universe is running: start one with obsim run SCENE.lua");
		return NULL;
	}
	ob_universe *u = ob_universe_attach(name ? name : names[0], &e);
	if (u)
		return u;
	ob_command_fail(*code, e.text);
	ob_spelling near = ob_spelling_start(name ? name : "");
	for (size_t i = 0; i < n; i++) {
		fprintf(stderr, "%s %s\n", i ? "        " : "running:", names[i]);
		ob_spelling_offer(&near, names[i]);
	}
	if (near.best)
		fprintf(stderr, "did you mean obsim top %s?\n", near.best);
	return NULL;
}

static void sleep_for(double s)
{
	struct timespec t = { (time_t)s, (long)((s - (double)(time_t)s) * 1e9) };
	nanosleep(&t, NULL);
}

static int print_once(const ob_universe *u, double interval)
{
	ob_top_sample sample = { 0 };
	ob_top_view view = { 0 };
	bool fine = ob_top_look(&sample, u);
	for (double until = ob_clock_wall() + interval; fine && ob_clock_wall() < until;) {
		sleep_for(watch_period);
		ob_top_watch(&sample, u);
	}
	fine = fine && ob_top_look(&sample, u);
	if (fine)
		ob_top_view_write(&view, &sample, stdout);
	ob_top_finish(&sample);
	return fine ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, "out of memory");
}

static void act(ob_key key, ob_top_view *view)
{
	uint32_t page = view->lines > 12 ? (uint32_t)view->lines - 10 : 2;
	uint32_t up = key == OB_KEY_UP ? 1 : key == OB_KEY_PAGE_UP ? page : 0;
	view->scroll -= up < view->scroll ? up : view->scroll;
	view->scroll += key == OB_KEY_DOWN ? 1 : key == OB_KEY_PAGE_DOWN ? page : 0;
	if (key == OB_KEY_WORKERS)
		view->workers = !view->workers, view->sensors = false;
	if (key == OB_KEY_SENSORS)
		view->sensors = !view->sensors, view->workers = false;
	if (key == OB_KEY_SORT)
		view->by_speed = !view->by_speed;
	if (key == OB_KEY_HOME || key == OB_KEY_WORKERS || key == OB_KEY_SORT || key == OB_KEY_SENSORS)
		view->scroll = 0;
	if (key == OB_KEY_END)
		view->scroll = UINT32_MAX / 2; // the view brings it into range
}

static bool draw(ob_top_view *view, ob_top_sample *sample)
{
	char *text = NULL;
	size_t length = 0;
	FILE *f = open_memstream(&text, &length);
	if (!f)
		return false;
	ob_terminal_size(&view->columns, &view->lines);
	ob_top_view_write(view, sample, f);
	fclose(f);
	ob_terminal_show(text, length);
	free(text);
	return true;
}

// Looks each interval, answers keys at once.
static bool watch(const ob_universe *u, double interval)
{
	ob_top_sample sample = { 0 };
	ob_top_view view = { 0 };
	ob_key key = OB_KEY_NONE;
	double next = 0;
	bool fine = true;
	while (fine && key != OB_KEY_QUIT) {
		if (ob_clock_wall() >= next) {
			fine = ob_top_look(&sample, u);
			// the first rates soon, the others at leisure
			next = ob_clock_wall() + (next == 0 ? fmin(interval, .5) : interval);
			key = OB_KEY_RESIZE;
		}
		act(key, &view);
		if (fine && key != OB_KEY_NONE)
			fine = draw(&view, &sample);
		key = ob_terminal_key(watch_period);
		ob_top_watch(&sample, u);
	}
	ob_top_finish(&sample);
	return fine;
}

int ob_command_top(const ob_arguments *a)
{
	double interval = 1;
	ob_error e;
	int code;
	if (!ob_number_real("interval", a->value[OB_OPTION_INTERVAL], 0, 3600, &interval, &e))
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	setlocale(LC_CTYPE, ""); // for names beyond ASCII
	ob_universe *u = attach(a->operand, &code);
	if (!u)
		return code;
	if (a->value[OB_OPTION_ONCE] || !isatty(STDOUT_FILENO)) {
		code = print_once(u, interval);
	} else if (!isatty(STDIN_FILENO) || !ob_terminal_enter()) {
		code = ob_command_fail(OB_EXIT_USAGE, "standard input is no terminal for its keys: use --once");
	} else {
		ob_pages_guard(ob_terminal_leave);
		bool fine = watch(u, interval);
		ob_pages_guard(NULL);
		ob_terminal_leave();
		code = fine ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, "out of memory");
	}
	ob_universe_detach(u);
	return code;
}
