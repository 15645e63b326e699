#include "lab/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/analysis.h"
#include "experiment/table.h"

// True if the engine has results in a case, or, with none named, in the chart so far.
static bool takes_part(const ob_chart *c, const ob_lab_analysis *d, const ob_case *of, const ob_engine_kind *k)
{
	if (of)
		return ob_lab_analysis_next(d, of, k, NULL);
	for (size_t i = 0; i < c->series_count; i++)
		if (c->series[i].count && c->series[i].style == ob_lab_analysis_style(d, k))
			return true;
	return false;
}

static void add_configuration(ob_chart *c, const ob_lab_analysis *d, const ob_case *of)
{
	OB_SAY(c->subtitle, "%sframes of 1/60 s", *c->subtitle ? " \u00b7 " : "");
	bool obsim = false, free = false; // its variants count alike here
	for (size_t i = 0; i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		free |= k->free && takes_part(c, d, of, k);
		if (!takes_part(c, d, of, k) || !k->usual.iterations || (obsim && ob_lab_analysis_is_obsim(k)))
			continue;
		if (ob_lab_analysis_is_obsim(k))
			OB_SAY(c->subtitle, " \u00b7 obsim: %u iterations", k->usual.iterations);
		else
			OB_SAY(c->subtitle, " \u00b7 %s: %u iterations", k->title, k->usual.iterations);
		obsim |= ob_lab_analysis_is_obsim(k);
	}
	OB_SAY(c->subtitle, " \u00b7 one worker, a thread%s \u00b7 sleeping off \u00b7 commit %s",
	       free ? "; free: two" : "", d->results->commit);
}

void ob_lab_chart_setting(const ob_result *r, char *to, size_t room)
{
	const ob_run_settings *s = &r->settings;
	if (s->tolerance > 0 && s->substeps)
		snprintf(to, room, "usual");
	else if (s->tolerance > 0)
		snprintf(to, room, "%s", ob_word_quantity(s->tolerance * 1e3, "mm").text);
	else if (ob_lab_analysis_is_obsim(r->engine) && !r->engine->free)
		snprintf(to, room, "%u", s->substeps);
	else
		snprintf(to, room, "%.0f Hz", s->substeps / s->step_length);
}

// ---- error over cost, and over substeps: a curve per engine

// Families that split the results of one engine into series.
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

static int by_fineness(const void *a, const void *b)
{
	double one = order_of(*(const ob_result *const *)a), other = order_of(*(const ob_result *const *)b);
	return (one > other) - (one < other);
}

// Collects the results of one series in their order; returns their number.
static size_t gather(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k, family f,
		     const ob_result **list)
{
	size_t count = 0;
	for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, c, k, r));)
		if (family_of(r) == f)
			list[count++] = r;
	qsort(list, count, sizeof *list, by_fineness);
	return count;
}

static bool is_failed(const ob_result *r)
{
	return r->outcome.failed[0] || !isfinite(r->outcome.figure[0]);
}

static void add_result(ob_chart *chart, const ob_result *r, double x)
{
	char label[32], hint[192];
	const ob_figure_def *def = &r->of->figure[0];
	ob_lab_chart_setting(r, label, sizeof label);
	if (r->settings.lag != r->engine->usual.lag)
		OB_SAY(label, ", lag %u", r->settings.lag);
	else if (family_of(r) == FAMILY_ITERATIONS && !(r->settings.tolerance > 0))
		OB_SAY(label, " \u00d7 %u", r->settings.iterations);
	const char *failed = r->outcome.failed[0] ? r->outcome.failed : "not a number";
	snprintf(hint, sizeof hint, "%s, %s%s, %u iterations: %.3g \u00b5s, %s", r->engine->title, label,
		 ob_lab_analysis_is_obsim(r->engine) && !r->engine->free && !(r->settings.tolerance > 0) ? " substeps"
													 : "",
		 r->settings.iterations, ob_result_cost(r) * 1e6,
		 is_failed(r) ? failed : ob_word_quantity(r->outcome.figure[0], def->unit).text);
	ob_chart_point *p = ob_chart_add(chart, x, is_failed(r) ? NAN : r->outcome.figure[0], label, hint);
	p->failed = is_failed(r);
}

// Completes a chart, of one case unless c is NULL: y is its first figure, if it has no label. Returns NULL for an empty one.
static ob_chart *finish(ob_chart *chart, const ob_lab_analysis *d, const ob_case *c, double width, double height)
{
	if (!chart->points) {
		ob_chart_free(chart);
		return NULL;
	}
	add_configuration(chart, d, c);
	chart->width = width;
	chart->height = height;
	if (!c || *chart->y.label)
		return chart;
	const ob_figure_def *def = &c->figure[0];
	OB_SAY(chart->y.label, strcmp(def->unit, "1") ? "%s (%s)" : "%s", def->name, ob_word_unit(def->unit).text);
	chart->y.scale = OB_SCALE_LOG;
	if (ob_lab_analysis_has_target(c, 0)) {
		chart->mark[chart->marks++] = (ob_chart_mark){ .at = def->target, .tinted = true };
		OB_SAY(chart->mark[0].label, "target %s", ob_word_quantity(def->target, def->unit).text);
	}
	return chart;
}

ob_chart *ob_lab_chart_cost(const ob_lab_analysis *d, const ob_case *c)
{
	ob_chart *chart = ob_chart_new();
	const ob_result **list = calloc(d->results->count + 1, sizeof *list);
	for (size_t i = 0; list && i < d->engines; i++) {
		const ob_engine_kind *k = d->engine[i];
		for (int f = 0; f < FAMILIES; f++) {
			char title[128];
			size_t count = gather(d, c, k, (family)f, list);
			snprintf(title, sizeof title, "%s%s", k->title, f == FAMILY_TOLERANCE ? ", by tolerance" : "");
			ob_chart_series *s = ob_chart_begin(chart, ob_lab_analysis_style(d, k), f != FAMILY_STEPS,
							    f == FAMILY_ITERATIONS ? "" : title);
			s->line = f != FAMILY_ITERATIONS;
			for (size_t j = 0; j < count; j++)
				add_result(chart, list[j], ob_result_cost(list[j]) * 1e6);
		}
	}
	free(list);
	OB_SAY(chart->name, "%s", c->name);
	OB_SAY(chart->title, "%s: error against cost", c->title);
	bool others = false; // there are points off the curves, with other numbers of iterations
	for (size_t i = 0; i < chart->series_count; i++)
		others |= chart->series[i].count && !*chart->series[i].title;
	OB_SAY(chart->subtitle,
	       "down and left is better \u00b7 at the points: substeps a frame (obsim), steps a second (others)%s",
	       others ? ", \u00d7 iterations" : "");
	OB_SAY(chart->x.label, "CPU per body and simulated second (\u00b5s)");
	chart->x.scale = OB_SCALE_LOG;
	return finish(chart, d, c, 860, 500);
}

// Appends the observed order to an engine's name.
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
	double order = ob_statistics_order(n, h, error, largest * 1e-12);
	if (isfinite(order))
		snprintf(to, room, "%s: order %.2f", k->title, order);
	else
		snprintf(to, room, "%s", k->title);
}

// Adds a guide line of first order, from the coarsest point of the first engine.
static void add_guide(ob_chart *chart)
{
	const ob_chart_series *s = chart->series;
	const ob_chart_point *at = chart->point + s->first, *first = NULL, *last = NULL;
	for (size_t i = 0; i < s->count; i++) {
		if (at[i].failed || !(at[i].y > 0))
			continue;
		first = first ? first : &at[i];
		last = &at[i];
	}
	if (!first || first == last)
		return;
	double x = first->x, y = first->y, end = last->x; // adding points moves earlier ones
	ob_chart_begin(chart, -1, false, "first order");
	ob_chart_add(chart, x, y, "", "");
	ob_chart_add(chart, end, y * x / end, "", "");
}

ob_chart *ob_lab_chart_convergence(const ob_lab_analysis *d, const ob_case *c)
{
	ob_chart *chart = ob_chart_new();
	const ob_result **list = calloc(d->results->count + 1, sizeof *list);
	for (size_t i = 0; list && i < d->engines; i++) {
		char title[128];
		size_t count = gather(d, c, d->engine[i], FAMILY_STEPS, list);
		if (count < 2)
			continue;
		name_order(d->engine[i], list, count, title, sizeof title);
		ob_chart_begin(chart, ob_lab_analysis_style(d, d->engine[i]), false, title);
		for (size_t j = 0; j < count; j++)
			add_result(chart, list[j], list[j]->settings.substeps);
	}
	free(list);
	for (size_t i = 0; i < chart->points; i++)
		chart->point[i].label[0] = 0; // the axis has this information
	add_guide(chart);
	OB_SAY(chart->name, "order-%s", c->name);
	OB_SAY(chart->title, "%s: order of convergence", c->title);
	OB_SAY(chart->x.label, "substeps a frame");
	chart->x.scale = OB_SCALE_LOG2;
	return finish(chart, d, c, 860, 440);
}

// ---- all cases, one below the other; and the cost of reading late

static const double row_height = 19; // px

// True if a case has a target, and results of obsim (and of "beside", unless it is NULL).
static bool has_row(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *beside)
{
	const ob_result *own = ob_lab_analysis_promised(d, c);
	return own && !isnan(ob_lab_analysis_ratio(own)) && (!beside || ob_lab_analysis_usual(d, c, beside));
}

static void add_row(ob_chart *chart, const ob_result *r, double at)
{
	double ratio = ob_lab_analysis_ratio(r);
	char hint[192];
	if (isfinite(ratio))
		snprintf(hint, sizeof hint, "%s, %s: %.3g of the target", r->of->title, r->engine->title, ratio);
	else
		snprintf(hint, sizeof hint, "%s, %s: %s", r->of->title, r->engine->title,
			 r->outcome.failed[0] ? r->outcome.failed : "missed a target of 0");
	ob_chart_point *p = ob_chart_add(chart, ratio, at, "", hint);
	p->failed = !isfinite(ratio);
}

// Adds one series: the results at usual settings of an engine (NULL: those promised by obsim), "dodge" rows off its
// own.
static void add_engine(ob_chart *chart, const ob_lab_analysis *d, const ob_engine_kind *k, const ob_engine_kind *beside,
		       double dodge)
{
	ob_chart_series *s =
		ob_chart_begin(chart, k ? ob_lab_analysis_style(d, k) : 0, k != NULL, k ? k->title : "obsim");
	s->line = false;
	int row = 0;
	for (const ob_case *const *c = ob_cases; *c && row < OB_CHART_CATEGORIES; c++) {
		if (!has_row(d, *c, beside))
			continue;
		const ob_result *r = k ? ob_lab_analysis_usual(d, *c, k) : ob_lab_analysis_promised(d, *c);
		if (r && !isnan(ob_lab_analysis_ratio(r)))
			add_row(chart, r, row + dodge);
		row++;
	}
}

static size_t name_rows(ob_chart *chart, const ob_lab_analysis *d, const ob_engine_kind *beside)
{
	size_t rows = 0;
	for (const ob_case *const *c = ob_cases; *c && rows < OB_CHART_CATEGORIES; c++) {
		if (!has_row(d, *c, beside))
			continue;
		if ((*c)->row > 0)
			snprintf(chart->category[rows], sizeof *chart->category, "%s \u00b7 %d", (*c)->title,
				 (*c)->row);
		else
			snprintf(chart->category[rows], sizeof *chart->category, "%s", (*c)->title);
		rows++;
	}
	return rows;
}

static ob_chart *finish_rows(ob_chart *chart, const ob_lab_analysis *d, const ob_engine_kind *beside)
{
	chart->categories = name_rows(chart, d, beside);
	OB_SAY(chart->x.label, "worst error of the case, over its target");
	chart->x.scale = OB_SCALE_LOG;
	chart->mark[0] = (ob_chart_mark){ .at = 1, .label = "target", .vertical = true, .tinted = true };
	chart->marks = 1;
	return finish(chart, d, NULL, 1000, 150 + row_height * (double)chart->categories);
}

ob_chart *ob_lab_chart_promises(const ob_lab_analysis *d)
{
	ob_chart *chart = ob_chart_new();
	add_engine(chart, d, NULL, NULL, 0);
	size_t others = 0, done = 0;
	for (size_t i = 0; i < d->engines; i++)
		others += !ob_lab_analysis_is_obsim(d->engine[i]);
	for (size_t i = 0; i < d->engines; i++)
		if (!ob_lab_analysis_is_obsim(d->engine[i]))
			add_engine(chart, d, d->engine[i], NULL, .22 * ((double)done++ - (double)(others - 1) / 2));
	OB_SAY(chart->name, "all-cases");
	OB_SAY(chart->title, "Every case: error against its target, at usual settings");
	OB_SAY(chart->subtitle, "left of the line: the target is met \u00b7 crosses: failed, or misses a target of 0 "
				"\u00b7 the number is the row of the table below");
	return finish_rows(chart, d, NULL);
}

static const ob_engine_kind *engine_named(const ob_lab_analysis *d, const char *name)
{
	for (size_t i = 0; i < d->engines; i++)
		if (!strcmp(d->engine[i]->name, name))
			return d->engine[i];
	return NULL;
}

ob_chart *ob_lab_chart_ghost(const ob_lab_analysis *d)
{
	const ob_engine_kind *ghost = engine_named(d, "obsim-ghost");
	if (!ghost)
		return NULL;
	ob_chart *chart = ob_chart_new();
	add_engine(chart, d, NULL, ghost, -.15);
	add_engine(chart, d, ghost, ghost, .15);
	OB_SAY(chart->name, "all-ghost");
	OB_SAY(chart->title, "Neighbours as ghosts of infinite mass: error against target");
	return finish_rows(chart, d, ghost);
}

// Adds the results of a free engine with a delay, as a series with its order.
static void add_delays(ob_chart *chart, const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k)
{
	enum { MOST = 16 };
	const ob_result *list[MOST];
	double lag[MOST] = { 0 }, error[MOST] = { 0 };
	char title[128];
	size_t n = 0;
	for (const ob_result *r = NULL; n < MOST && (r = ob_lab_analysis_next(d, c, k, r));) {
		if (r->settings.lag == 0)
			continue;
		lag[n] = r->settings.lag;
		error[n] = is_failed(r) ? NAN : r->outcome.figure[0];
		list[n++] = r;
	}
	const double order = ob_statistics_order(n, lag, error, 0);
	snprintf(title, sizeof title, isfinite(order) ? "%s: order %.2f" : "%s", k->title, order);
	ob_chart_begin(chart, ob_lab_analysis_style(d, k), false, title);
	for (size_t i = 0; i < n; i++)
		add_result(chart, list[i], lag[i]);
}

ob_chart *ob_lab_chart_delay(const ob_lab_analysis *d, const ob_case *c)
{
	ob_chart *chart = ob_chart_new();
	for (size_t i = 0; i < d->engines; i++)
		if (d->engine[i]->free)
			add_delays(chart, d, c, d->engine[i]);
	for (size_t i = 0; i < chart->points; i++)
		chart->point[i].label[0] = 0; // the axis has this information
	OB_SAY(chart->name, "delay-%s", c->name);
	OB_SAY(chart->title, "%s: error of free simulators over the delay", c->title);
	OB_SAY(chart->x.label, "ms until a publication is seen");
	chart->x.scale = OB_SCALE_LOG;
	return finish(chart, d, c, 860, 440);
}

ob_chart *ob_lab_chart_lag(const ob_lab_analysis *d)
{
	const ob_engine_kind *late = engine_named(d, "obsim-lag");
	const ob_case *c = ob_case_find("lag");
	ob_chart *chart = ob_chart_new();
	for (uint32_t figure = 0; late && c && figure < c->figures; figure++) {
		ob_chart_begin(chart, (int)figure, false, c->figure[figure].name);
		for (const ob_result *r = NULL; (r = ob_lab_analysis_next(d, c, late, r));) {
			bool failed = r->outcome.failed[0] || !isfinite(r->outcome.figure[figure]);
			ob_chart_point *p =
				ob_chart_add(chart, r->settings.lag, failed ? NAN : r->outcome.figure[figure], "", "");
			p->failed = failed;
		}
	}
	OB_SAY(chart->name, "lag");
	OB_SAY(chart->title, "Error of reading a partner late");
	OB_SAY(chart->x.label, "iterations that a partner's state is late");
	OB_SAY(chart->y.label, "relative error");
	chart->y.scale = OB_SCALE_LOG;
	return finish(chart, d, c, 760, 400);
}
