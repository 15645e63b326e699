// Draws one diagram: reads its description from standard input, writes an SVG to standard output. One line each:
//
//   title TEXT, subtitle TEXT
//   x SCALE LABEL, y SCALE LABEL    SCALE: linear, log, log2
//   series STYLE TITLE              the style numbers of plot/plot.h; the points that follow belong to it
//   point X Y LOW HIGH [LABEL]      LOW and HIGH: the error bar, 0 0 for none
//
// Exit 2, with one line, if a line is not understood.
#include "plot/plot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS 64 // of one series
#define SERIES 8
#define LINE 512

static char texts[POINTS * SERIES][LINE];
static size_t text_count;

// A copy that lasts as long as the program.
static const char *keep(const char *text)
{
	if (text_count == POINTS * SERIES)
		return NULL;
	return strcpy(texts[text_count++], text);
}

static bool read_axis(const char *text, ob_plot_axis *axis)
{
	static const char *const names[] = { [OB_SCALE_LINEAR] = "linear", [OB_SCALE_LOG] = "log", [OB_SCALE_LOG2] = "log2" };
	char scale[16];
	int end = 0;
	if (sscanf(text, "%15s %n", scale, &end) != 1)
		return false;
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		if (strcmp(scale, names[i]) == 0) {
			axis->scale = (ob_plot_scale)i;
			axis->label = keep(text + end);
			return axis->label;
		}
	}
	return false;
}

static bool read_point(const char *text, ob_plot_point *p)
{
	int end = 0;
	if (sscanf(text, "%lf %lf %lf %lf%n", &p->x, &p->y, &p->low, &p->high, &end) != 4)
		return false;
	p->label = text[end] == ' ' ? keep(text + end + 1) : NULL;
	return true;
}

static bool read_line(const char *line, ob_plot *plot, ob_plot_series series[SERIES], ob_plot_point point[SERIES][POINTS])
{
	char word[16];
	int end = 0;
	if (sscanf(line, "%15s %n", word, &end) != 1)
		return false;
	const char *rest = line + end;
	if (strcmp(word, "title") == 0)
		return (plot->title = keep(rest));
	if (strcmp(word, "subtitle") == 0)
		return (plot->subtitle = keep(rest));
	if (strcmp(word, "x") == 0)
		return read_axis(rest, &plot->x);
	if (strcmp(word, "y") == 0)
		return read_axis(rest, &plot->y);
	if (strcmp(word, "series") == 0 && plot->series_count < SERIES) {
		ob_plot_series *s = &series[plot->series_count];
		char *title = NULL;
		s->style = (int)strtol(rest, &title, 10);
		s->title = keep(title + (*title == ' '));
		s->point = point[plot->series_count++];
		s->line = true;
		return s->title;
	}
	ob_plot_series *last = plot->series_count ? &series[plot->series_count - 1] : NULL;
	return strcmp(word, "point") == 0 && last && last->count < POINTS &&
	       read_point(rest, &point[plot->series_count - 1][last->count++]);
}

int main(void)
{
	static ob_plot_series series[SERIES];
	static ob_plot_point point[SERIES][POINTS];
	ob_plot plot = { .series = series };
	char line[LINE];
	for (int number = 1; fgets(line, sizeof line, stdin); number++) {
		line[strcspn(line, "\n")] = '\0';
		if (!read_line(line, &plot, series, point)) {
			fprintf(stderr, "draw_plot: line %d is not understood, or is one too many: %s\n", number, line);
			return 2;
		}
	}
	ob_error e = { 0 };
	char *svg = ob_plot_svg_text(&plot, &e);
	if (!svg) {
		fprintf(stderr, "draw_plot: %s\n", e.text);
		return 1;
	}
	fputs(svg, stdout);
	free(svg);
	return 0;
}
