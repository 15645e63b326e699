// All cases in one diagram, one below the other; and what reading late costs.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lab/chart.h"
#include "experiment/page.h"

static const double row_height = 19; // px

// Is there something to show of a case: a target, and results of obsim (and of "beside", unless it is NULL)?
static bool has_row(const ob_digest *d, const ob_case *c, const ob_engine_kind *beside)
{
	const ob_result *own = ob_digest_promised(d, c);
	return own && !isnan(ob_digest_ratio(own)) && (!beside || ob_digest_usual(d, c, beside));
}

static void add_row(ob_chart *chart, const ob_result *r, double at)
{
	double ratio = ob_digest_ratio(r);
	char hint[192];
	if (isfinite(ratio))
		snprintf(hint, sizeof hint, "%s, %s: %.3g of the target", r->of->title, r->engine->title, ratio);
	else
		snprintf(hint, sizeof hint, "%s, %s: %s", r->of->title, r->engine->title,
			 r->outcome.failed[0] ? r->outcome.failed : "missed a target of 0");
	ob_plot_point *p = ob_chart_add(chart, ratio, at, "", hint);
	p->failed = !isfinite(ratio);
}

// One series: the results at usual settings of an engine (NULL: what obsim promises), "dodge" rows off its own
static void add_engine(ob_chart *chart, const ob_digest *d, const ob_engine_kind *k, const ob_engine_kind *beside,
		       double dodge)
{
	ob_plot_series *s = ob_chart_begin(chart, k ? ob_digest_style(d, k) : 0, k != NULL, k ? k->title : "obsim");
	s->line = false;
	int row = 0;
	for (const ob_case *const *c = ob_cases; *c && row < OB_CHART_CASES; c++) {
		if (!has_row(d, *c, beside))
			continue;
		const ob_result *r = k ? ob_digest_usual(d, *c, k) : ob_digest_promised(d, *c);
		if (r && !isnan(ob_digest_ratio(r)))
			add_row(chart, r, row + dodge);
		row++;
	}
}

static size_t name_rows(ob_chart *chart, const ob_digest *d, const ob_engine_kind *beside)
{
	size_t rows = 0;
	for (const ob_case *const *c = ob_cases; *c && rows < OB_CHART_CASES; c++) {
		if (!has_row(d, *c, beside))
			continue;
		if ((*c)->row > 0)
			snprintf(chart->category_text[rows], sizeof *chart->category_text, "%s \u00b7 %d", (*c)->title,
				 (*c)->row);
		else
			snprintf(chart->category_text[rows], sizeof *chart->category_text, "%s", (*c)->title);
		chart->category[rows] = chart->category_text[rows];
		rows++;
	}
	return rows;
}

static ob_chart *end(ob_chart *chart, const ob_digest *d, const ob_engine_kind *beside)
{
	size_t rows = name_rows(chart, d, beside);
	if (!rows) {
		ob_chart_free(chart);
		return NULL;
	}
	if (!chart->series[chart->plot.series_count - 1].count)
		chart->plot.series_count--;
	ob_chart_configuration(chart, d, NULL);
	snprintf(chart->x_label, sizeof chart->x_label, "worst error of the case, over its target");
	chart->plot.x.scale = OB_SCALE_LOG;
	chart->plot.y = (ob_plot_axis){ .scale = OB_SCALE_CATEGORY, .categories = rows, .category = chart->category };
	chart->mark[0] = (ob_plot_mark){ .at = 1, .vertical = true, .label = "target", .tinted = true };
	chart->plot.marks = 1;
	chart->plot.width = 1000;
	chart->plot.height = 150 + row_height * (double)rows;
	return chart;
}

ob_chart *ob_chart_promises(const ob_digest *d)
{
	ob_chart *chart = ob_chart_new(OB_CHART_CASES * OB_DIGEST_ENGINES);
	if (!chart)
		return NULL;
	add_engine(chart, d, NULL, NULL, 0);
	size_t others = 0, done = 0;
	for (size_t i = 0; i < d->engines; i++)
		others += !ob_digest_is_obsim(d->engine[i]);
	for (size_t i = 0; i < d->engines; i++)
		if (!ob_digest_is_obsim(d->engine[i]))
			add_engine(chart, d, d->engine[i], NULL, .22 * ((double)done++ - (double)(others - 1) / 2));
	snprintf(chart->title, sizeof chart->title, "Every case: error against its target, at usual settings");
	snprintf(chart->subtitle, sizeof chart->subtitle,
		 "left of the line: the target is met \u00b7 crosses: failed, or misses a target of 0 \u00b7 the "
		 "number is the row of "
		 "the table below");
	return end(chart, d, NULL);
}

static const ob_engine_kind *engine_named(const ob_digest *d, const char *name)
{
	for (size_t i = 0; i < d->engines; i++)
		if (!strcmp(d->engine[i]->name, name))
			return d->engine[i];
	return NULL;
}

ob_chart *ob_chart_ghost(const ob_digest *d)
{
	const ob_engine_kind *ghost = engine_named(d, "obsim-ghost");
	ob_chart *chart = ghost ? ob_chart_new(OB_CHART_CASES * 2) : NULL;
	if (!chart)
		return NULL;
	add_engine(chart, d, NULL, ghost, -.15);
	add_engine(chart, d, ghost, ghost, .15);
	snprintf(chart->title, sizeof chart->title, "Neighbours as ghosts of infinite mass: error against target");
	return end(chart, d, ghost);
}

ob_chart *ob_chart_lag(const ob_digest *d)
{
	const ob_engine_kind *late = engine_named(d, "obsim-lag");
	const ob_case *c = ob_case_find("lag");
	ob_chart *chart = late && c ? ob_chart_new(d->results->count * OB_FIGURES) : NULL;
	if (!chart)
		return NULL;
	for (uint32_t figure = 0; figure < c->figures; figure++) {
		ob_chart_begin(chart, (int)figure, false, c->figure[figure].name);
		for (size_t i = 0; i < d->results->count; i++) {
			const ob_result *r = &d->results->result[i];
			if (r->of != c || r->engine != late)
				continue;
			bool failed = r->outcome.failed[0] || !isfinite(r->outcome.figure[figure]);
			ob_plot_point *p =
				ob_chart_add(chart, r->settings.lag, failed ? NAN : r->outcome.figure[figure], "", "");
			p->failed = failed;
		}
	}
	if (!chart->points) {
		ob_chart_free(chart);
		return NULL;
	}
	snprintf(chart->title, sizeof chart->title, "What it costs to read a partner late");
	ob_chart_configuration(chart, d, c);
	snprintf(chart->x_label, sizeof chart->x_label, "exchanges that a partner's state is late");
	snprintf(chart->y_label, sizeof chart->y_label, "relative error");
	chart->plot.y.scale = OB_SCALE_LOG;
	chart->plot.width = 760;
	chart->plot.height = 400;
	return chart;
}
