#include "experiment/progress.h"

#include <math.h>
#include <stdio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "base/clock.h"

static const double elsewhere_s = 30; // between two lines if standard error is no terminal

void ob_progress_print_time(char *text, size_t size, double s)
{
	if (s < 100)
		snprintf(text, size, "%.0f s", s);
	else if (s < 6000)
		snprintf(text, size, "%d min %d s", (int)s / 60, (int)s % 60);
	else
		snprintf(text, size, "%.1f h", s / 3600);
}

void ob_progress_print(char *to, size_t room, double done, double all, double left_s, const char *what)
{
	enum { BAR = 20 };
	static const char hashes[] = "####################";
	char left[48] = "-";
	int filled = all > 0 ? (int)(BAR * fmin(done / all, 1)) : 0;
	if (!isnan(left_s))
		ob_progress_print_time(left, sizeof left, left_s);
	snprintf(to, room, "[%.*s%*s] %.0f of %.0f, %s left: %s", filled, hashes, BAR - filled, "", done, all, left,
		 what);
}

static int terminal_columns(void)
{
	struct winsize size = { 0 };
	return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

void ob_progress_show(ob_progress_view *v, double done, double all, double left_s, const char *what)
{
	char line[400];
	double now = ob_clock_wall();
	ob_progress_print(line, sizeof line, done, all, left_s, what);
	if (isatty(STDERR_FILENO)) {
		fprintf(stderr, "\r\033[K%.*s", terminal_columns() - 1, line);
		v->shown = now;
	} else if (v->shown == 0) {
		v->shown = now; // short operations print nothing
	} else if (now - v->shown >= elsewhere_s) {
		fprintf(stderr, "%s\n", line);
		v->shown = now;
	}
	fflush(stderr);
}

void ob_progress_clear(ob_progress_view *v)
{
	if (v->shown > 0 && isatty(STDERR_FILENO))
		fputs("\r\033[K", stderr);
	v->shown = 0;
}
