#include "lab/chart.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/page.h"

ob_chart *ob_chart_new(size_t points)
{
	ob_chart *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->points_max = points;
	c->point = calloc(points + 1, sizeof *c->point);
	c->text = calloc(points + 1, sizeof *c->text);
	if (!c->point || !c->text) {
		ob_chart_free(c);
		return NULL;
	}
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

ob_plot_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title)
{
	ob_plot *p = &c->plot;
	if (p->series_count && !c->series[p->series_count - 1].count) // the last one has stayed empty
		p->series_count--;
	size_t i = p->series_count < OB_CHART_SERIES ? p->series_count++ : OB_CHART_SERIES - 1;
	snprintf(c->series_title[i], sizeof c->series_title[i], "%s", title);
	c->series[i] = (ob_plot_series){ .title = *title ? c->series_title[i] : NULL,
					 .point = c->point + c->points,
					 .style = style,
					 .hollow = hollow,
					 .line = true };
	return &c->series[i];
}

ob_plot_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint)
{
	static ob_plot_point spare;
	if (c->points == c->points_max)
		return &spare;
	ob_chart_point_text *text = &c->text[c->points];
	snprintf(text->label, sizeof text->label, "%s", label);
	snprintf(text->hint, sizeof text->hint, "%s", hint);
	ob_plot_point *p = &c->point[c->points++];
	*p = (ob_plot_point){ .x = x, .y = y, .label = *label ? text->label : NULL, .hint = *hint ? text->hint : NULL };
	c->series[c->plot.series_count - 1].count++;
	return p;
}

static void append(char *to, size_t room, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void append(char *to, size_t room, const char *format, ...)
{
	size_t used = strlen(to);
	va_list args;
	va_start(args, format);
	vsnprintf(to + used, room - used, format, args);
	va_end(args);
}

// In a case, or, where none is named, in the chart as it is so far
static bool takes_part(const ob_chart *c, const ob_digest *d, const ob_case *of, const ob_engine_kind *k)
{
	for (size_t i = 0; of && i < d->results->count; i++)
		if (d->results->result[i].of == of && d->results->result[i].engine == k)
			return true;
	for (size_t i = 0; !of && i < c->plot.series_count; i++)
		if (c->series[i].style == ob_digest_style(d, k))
			return true;
	return false;
}

void ob_chart_configuration(ob_chart *c, const ob_digest *d, const ob_case *of)
{
	char *to = c->subtitle;
	size_t room = sizeof c->subtitle;
	append(to, room, "%sframes of 1/%.0f s", *to ? " \u00b7 " : "", of ? 1 / of->step : 60);
	bool obsim = false; // its variants are alike in this
	for (size_t i = 0; i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		if (!takes_part(c, d, of, k) || !k->usual.iterations || (obsim && ob_digest_is_obsim(k)))
			continue;
		if (ob_digest_is_obsim(k))
			append(to, room, " \u00b7 obsim: %u rounds", k->usual.iterations);
		else
			append(to, room, " \u00b7 %s: %u iterations", k->title, k->usual.iterations);
		obsim |= ob_digest_is_obsim(k);
	}
	append(to, room, " \u00b7 one worker, a thread \u00b7 sleeping off \u00b7 commit %s", d->results->commit);
}

void ob_chart_setting(const ob_result *r, char *to, size_t room)
{
	const ob_run_settings *s = &r->settings;
	if (s->tolerance > 0 && s->substeps)
		snprintf(to, room, "usual");
	else if (s->tolerance > 0)
		ob_page_print_quantity(to, room, s->tolerance * 1e3, "mm");
	else if (ob_digest_is_obsim(r->engine))
		snprintf(to, room, "%u", s->substeps);
	else
		snprintf(to, room, "%.0f Hz", s->substeps / s->step_length);
}
