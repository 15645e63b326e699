// Error over cost, and over substeps: a curve an engine.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab/chart.h"
#include "experiment/page.h"
#include "reference/statistics.h"

// How the results of one engine fall into series
typedef enum family { FAMILY_STEPS, FAMILY_TOLERANCE, FAMILY_ITERATIONS, FAMILIES } family;

static family family_of(const ob_result *r)
{
	if (r->settings.tolerance > 0)
		return r->settings.substeps ? FAMILY_ITERATIONS : FAMILY_TOLERANCE;
	return r->settings.iterations == r->engine->usual.iterations && r->settings.lag == r->engine->usual.lag
		       ? FAMILY_STEPS
		       : FAMILY_ITERATIONS;
}

static double order_of(const ob_result *r) // along a curve: from coarse to fine
{
	return r->settings.tolerance > 0 ? -r->settings.tolerance : r->settings.substeps;
}

static int compare(const void *a, const void *b)
{
	double one = order_of(*(const ob_result *const *)a), other = order_of(*(const ob_result *const *)b);
	return (one > other) - (one < other);
}

// The results of one series in their order; returns how many.
static size_t gather(const ob_digest *d, const ob_case *c, const ob_engine_kind *k, family f, const ob_result **list)
{
	size_t count = 0;
	for (size_t i = 0; i < d->results->count; i++) {
		const ob_result *r = &d->results->result[i];
		if (r->of == c && r->engine == k && family_of(r) == f)
			list[count++] = r;
	}
	qsort(list, count, sizeof *list, compare);
	return count;
}

static bool is_failed(const ob_result *r)
{
	return r->outcome.failed[0] || !isfinite(r->outcome.figure[0]);
}

static void add_result(ob_chart *chart, const ob_result *r, double x)
{
	char label[32], hint[192], error[48];
	const ob_figure_def *def = &r->of->figure[0];
	ob_chart_setting(r, label, sizeof label);
	size_t used = strlen(label);
	if (r->settings.lag != r->engine->usual.lag)
		snprintf(label + used, sizeof label - used, ", lag %u", r->settings.lag);
	else if (family_of(r) == FAMILY_ITERATIONS && !(r->settings.tolerance > 0))
		snprintf(label + used, sizeof label - used, " \u00d7 %u", r->settings.iterations);
	ob_page_print_quantity(error, sizeof error, r->outcome.figure[0], def->unit);
	const char *failed = r->outcome.failed[0] ? r->outcome.failed : "not a number";
	snprintf(hint, sizeof hint, "%s, %s%s, %u iterations: %.3g \u00b5s, %s", r->engine->title, label,
		 ob_digest_is_obsim(r->engine) && !(r->settings.tolerance > 0) ? " substeps" : "",
		 r->settings.iterations, ob_result_cost(r) * 1e6, is_failed(r) ? failed : error);
	ob_plot_point *p = ob_chart_add(chart, x, is_failed(r) ? NAN : r->outcome.figure[0], label, hint);
	p->failed = is_failed(r);
}

static void name_axis(const ob_figure_def *def, char *to, size_t room)
{
	char unit[40];
	ob_page_print_unit(unit, sizeof unit, def->unit);
	if (!strcmp(unit, "1"))
		snprintf(to, room, "%s", def->name);
	else
		snprintf(to, room, "%s (%s)", def->name, unit);
}

static void mark_target(ob_chart *chart, const ob_case *c)
{
	char target[48];
	if (!ob_digest_has_target(c, 0))
		return;
	ob_page_print_quantity(target, sizeof target, c->figure[0].target, c->figure[0].unit);
	snprintf(chart->mark_label, sizeof chart->mark_label, "target %s", target);
	chart->mark[0] = (ob_plot_mark){ .at = c->figure[0].target, .label = chart->mark_label, .tinted = true };
	chart->plot.marks = 1;
}

// Nothing to show is no chart.
static ob_chart *end(ob_chart *chart, const ob_result **list)
{
	free(list);
	if (chart && chart->plot.series_count && !chart->series[chart->plot.series_count - 1].count)
		chart->plot.series_count--;
	if (chart && !chart->points) {
		ob_chart_free(chart);
		return NULL;
	}
	return chart;
}

ob_chart *ob_chart_cost(const ob_digest *d, const ob_case *c)
{
	ob_chart *chart = ob_chart_new(d->results->count);
	const ob_result **list = calloc(d->results->count + 1, sizeof *list);
	for (size_t i = 0; chart && list && i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		for (int f = 0; f < FAMILIES; f++) {
			char title[128];
			size_t count = gather(d, c, k, (family)f, list);
			snprintf(title, sizeof title, "%s%s", k->title, f == FAMILY_TOLERANCE ? ", by tolerance" : "");
			ob_plot_series *s = ob_chart_begin(chart, ob_digest_style(d, k), f != FAMILY_STEPS,
							   f == FAMILY_ITERATIONS ? "" : title);
			s->line = f != FAMILY_ITERATIONS;
			for (size_t j = 0; j < count; j++)
				add_result(chart, list[j], ob_result_cost(list[j]) * 1e6);
		}
	}
	chart = end(chart, list);
	if (!chart)
		return NULL;
	snprintf(chart->title, sizeof chart->title, "%s: error against cost", c->title);
	bool others = false; // points off the curves, of other numbers of iterations
	for (size_t i = 0; i < chart->plot.series_count; i++)
		others |= !chart->series[i].title;
	snprintf(chart->subtitle, sizeof chart->subtitle,
		 "down and left is better \u00b7 at the points: substeps a frame (obsim), steps a second (others)%s",
		 others ? ", \u00d7 iterations" : "");
	ob_chart_configuration(chart, d, c);
	snprintf(chart->x_label, sizeof chart->x_label, "CPU per body and simulated second (\u00b5s)");
	name_axis(&c->figure[0], chart->y_label, sizeof chart->y_label);
	chart->plot.x.scale = chart->plot.y.scale = OB_SCALE_LOG;
	mark_target(chart, c);
	chart->plot.width = 860;
	chart->plot.height = 500;
	return chart;
}

// Behind an engine's name: the order at which its error falls
static void name_order(const ob_engine_kind *k, const ob_result *const *list, size_t count, char *to, size_t room)
{
	double h[64], error[64], largest = 0;
	size_t n = 0;
	for (size_t i = 0; i < count && n < 64; i++) {
		if (is_failed(list[i]))
			continue;
		h[n] = 1. / list[i]->settings.substeps;
		error[n++] = list[i]->outcome.figure[0];
		largest = fmax(largest, list[i]->outcome.figure[0]);
	}
	double order = ob_reference_order(n, h, error, largest * 1e-12);
	if (isfinite(order))
		snprintf(to, room, "%s: order %.2f", k->title, order);
	else
		snprintf(to, room, "%s", k->title);
}

// Errors that fall as the first power of the step, from the coarsest one of the first engine's
static void add_guide(ob_chart *chart)
{
	const ob_plot_series *s = chart->series;
	const ob_plot_point *first = NULL, *last = NULL;
	for (size_t i = 0; i < s->count; i++) {
		if (s->point[i].failed || !(s->point[i].y > 0))
			continue;
		first = first ? first : &s->point[i];
		last = &s->point[i];
	}
	if (!first || first == last)
		return;
	ob_chart_begin(chart, -1, false, "first order");
	ob_chart_add(chart, first->x, first->y, "", "");
	ob_chart_add(chart, last->x, first->y * first->x / last->x, "", "");
}

ob_chart *ob_chart_convergence(const ob_digest *d, const ob_case *c)
{
	ob_chart *chart = ob_chart_new(d->results->count + 2);
	const ob_result **list = calloc(d->results->count + 1, sizeof *list);
	for (size_t i = 0; chart && list && i < d->engines; i++) {
		char title[128];
		size_t count = gather(d, c, d->engine[i], FAMILY_STEPS, list);
		if (count < 2)
			continue;
		name_order(d->engine[i], list, count, title, sizeof title);
		ob_chart_begin(chart, ob_digest_style(d, d->engine[i]), false, title);
		for (size_t j = 0; j < count; j++)
			add_result(chart, list[j], list[j]->settings.substeps);
	}
	chart = end(chart, list);
	if (!chart)
		return NULL;
	for (size_t i = 0; i < chart->points; i++)
		chart->point[i].label = NULL; // the axis says it
	add_guide(chart);
	snprintf(chart->title, sizeof chart->title, "%s: order of convergence", c->title);
	ob_chart_configuration(chart, d, c);
	snprintf(chart->x_label, sizeof chart->x_label, "substeps a frame");
	name_axis(&c->figure[0], chart->y_label, sizeof chart->y_label);
	chart->plot.x.scale = OB_SCALE_LOG2;
	chart->plot.y.scale = OB_SCALE_LOG;
	mark_target(chart, c);
	chart->plot.width = 860;
	chart->plot.height = 440;
	return chart;
}
