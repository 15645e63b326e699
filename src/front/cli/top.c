// obsim top: looks into a running universe from outside, as any program that links libobsim can.
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/spelling.h"
#include "cli/command.h"
#include "cli/quantity.h"
#include "cli/terminal.h"
#include "cli/top.h"
#include "table/table.h"

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
		view->workers = !view->workers;
	if (key == OB_KEY_SORT)
		view->by_speed = !view->by_speed;
	if (key == OB_KEY_HOME || key == OB_KEY_WORKERS || key == OB_KEY_SORT)
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
