#include "experiment/chart.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/allocate.h"

enum { PATH = 4096 };
#define PNG_ZOOM 2

ob_chart *ob_chart_new(void)
{
	ob_chart *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->plot.series = c->series;
	c->plot.mark = c->mark;
	c->plot.title = c->title;
	c->plot.subtitle = c->subtitle;
	c->plot.x.label = c->x_label;
	c->plot.y.label = c->y_label;
	return c;
}

void ob_chart_free(ob_chart *c)
{
	if (!c)
		return;
	free(c->point);
	free(c->text);
	free(c);
}

static void drop_empty(ob_chart *c)
{
	if (c->plot.series_count && !c->series[c->plot.series_count - 1].count)
		c->plot.series_count--;
}

ob_plot_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title)
{
	drop_empty(c);
	size_t i = c->plot.series_count < OB_CHART_SERIES ? c->plot.series_count++ : OB_CHART_SERIES - 1;
	snprintf(c->series_title[i], sizeof c->series_title[i], "%s", title);
	c->series[i] = (ob_plot_series){
		.title = *title ? c->series_title[i] : NULL, .style = style, .hollow = hollow, .line = true
	};
	c->first[i] = c->points;
	return &c->series[i];
}

static bool make_room(ob_chart *c)
{
	if (c->points < c->points_max)
		return true;
	size_t max = c->points_max ? 2 * c->points_max : 64;
	if (!OB_GROW(c->point, max) || !OB_GROW(c->text, max))
		return false;
	c->points_max = max;
	return true;
}

ob_plot_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint)
{
	static ob_plot_point spare;
	if (!c->plot.series_count || !make_room(c))
		return &spare;
	ob_chart_text *text = &c->text[c->points];
	snprintf(text->label, sizeof text->label, "%s", label);
	snprintf(text->hint, sizeof text->hint, "%s", hint);
	ob_plot_point *p = &c->point[c->points++];
	// any text marks that there is one, until its address is known
	*p = (ob_plot_point){ .x = x, .y = y, .label = *label ? "" : NULL, .hint = *hint ? "" : NULL };
	c->series[c->plot.series_count - 1].count++;
	return p;
}

const ob_plot *ob_chart_plot(ob_chart *c)
{
	if (!c || !c->points)
		return NULL;
	drop_empty(c);
	for (size_t i = 0; i < c->points; i++) {
		if (c->point[i].label)
			c->point[i].label = c->text[i].label;
		if (c->point[i].hint)
			c->point[i].hint = c->text[i].hint;
	}
	for (size_t i = 0; i < c->plot.series_count; i++)
		c->series[i].point = c->point + c->first[i];
	return &c->plot;
}

bool ob_chart_write(ob_chart *c, const char *dir, const char *name, ob_error *e)
{
	char path[PATH];
	const ob_plot *plot = ob_chart_plot(c);
	bool fine = true;
	if (plot && snprintf(path, sizeof path, "%s/plots/%s.svg", dir, name) >= PATH)
		fine = ob_fail(e, "the name of the folder is too long: %s", dir);
	if (plot && fine) {
		snprintf(path, sizeof path, "%s/plots", dir);
		fine = !mkdir(path, 0777) || errno == EEXIST || ob_fail(e, "cannot make the folder %s: %m", path);
		snprintf(path, sizeof path, "%s/plots/%s.svg", dir, name);
		fine = fine && ob_plot_svg(plot, path, e);
		snprintf(path, sizeof path, "%s/plots/%s.png", dir, name);
		fine = fine && ob_plot_png(plot, path, PNG_ZOOM, e);
	}
	ob_chart_free(c);
	return fine;
}

bool ob_chart_write_point(ob_chart *c, const char *dir, const char *of, const char *define, ob_error *e)
{
	char name[160];
	snprintf(name, sizeof name, "%s%s%s", of, *define ? "-" : "", define);
	for (char *at = name; *at; at++)
		if (!isalnum((unsigned char)*at) && !strchr(".-", *at))
			*at = '-';
	return ob_chart_write(c, dir, name, e);
}

void ob_chart_html(ob_chart *c, ob_page *p)
{
	const ob_plot *plot = ob_chart_plot(c);
	char *svg = plot ? ob_plot_svg_text(plot, NULL) : NULL;
	if (svg)
		fputs(svg, p->out);
	free(svg);
	ob_chart_free(c);
}
