#include "paper/chart.h"

#include <math.h>
#include <stdlib.h>

#include "paper/words.h"

enum { SERIES = 6, POINTS = 256, CURVE = 60 };
enum { STYLE_OBS = 0, STYLE_POOL = 1, STYLE_ONE = 2, STYLE_COMMON = 5, STYLE_GUIDE = -1 };

struct ob_paper_chart {
	ob_plot plot;
	ob_plot_series series[SERIES];
	ob_plot_point point[SERIES][POINTS];
	char title[160], subtitle[400], y_label[120], guide[2][48];
};

static const struct {
	const char *name, *caption;
	ob_paper_quantity quantity;
	bool growth;
	ob_paper_scenario scenario; // of growth
	ob_plot_scale scale;
} charts[OB_PAPER_CHARTS] = {
	{ "figure-14", "Figure 14. Runtime", OB_PAPER_STEP, false, 0, OB_SCALE_LOG },
	{ "figure-15", "Figure 15. Frame rates", OB_PAPER_FPS, false, 0, OB_SCALE_LOG },
	{ "figure-16", "Figure 16. CPU usage", OB_PAPER_CPU, false, 0, OB_SCALE_LOG },
	{ "figure-6-common", "Figure 6, the common environment. CPU against the number of objects", OB_PAPER_DEMAND,
	  true, OB_PAPER_COMMON, OB_SCALE_LINEAR },
	{ "figure-6-obs", "Figure 6, OBS. CPU against the number of objects", OB_PAPER_DEMAND, true, OB_PAPER_OBS,
	  OB_SCALE_LINEAR },
	{ "figure-6-obs-shown", "Figure 6, OBS as a system monitor shows it", OB_PAPER_CPU, true, OB_PAPER_OBS,
	  OB_SCALE_LINEAR },
};

const char *ob_paper_chart_name(int chart)
{
	return charts[chart].name;
}

const char *ob_paper_chart_caption(int chart)
{
	return charts[chart].caption;
}

static ob_plot_series *begin(ob_paper_chart *c, const char *title, int style, bool hollow)
{
	size_t i = c->plot.series_count++;
	c->series[i] = (ob_plot_series){
		.title = title, .point = c->point[i], .style = style, .line = true, .hollow = hollow
	};
	return &c->series[i];
}

static void add(ob_paper_chart *c, double x, double y, const char *label)
{
	size_t i = c->plot.series_count - 1;
	if (c->series[i].count < POINTS && isfinite(y))
		c->point[i][c->series[i].count++] = (ob_plot_point){ .x = x, .y = y, .label = label };
}

static void add_experiments(ob_paper_chart *c, const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q,
			    const char *title, int style, bool hollow)
{
	begin(c, title, style, hollow);
	for (uint32_t k = 0; k < r->experiments; k++) {
		const ob_paper_sample *at = ob_paper_find(r, s, k);
		if (at)
			add(c, k + 1, ob_paper_value(at, q) * ob_paper_quantities[q].scale, NULL);
	}
	if (c->series[c->plot.series_count - 1].count == 0)
		c->plot.series_count--;
}

static void draw_experiments(ob_paper_chart *c, const ob_paper_matter *m, ob_paper_quantity q)
{
	const char *common = "common", *obs = "OBS, one process an object";
	if (q == OB_PAPER_STEP) {
		common = "common: the step";
		obs = "OBS, one process an object: the step";
	}
	add_experiments(c, m->here, OB_PAPER_COMMON, q, common, STYLE_COMMON, false);
	add_experiments(c, m->here, OB_PAPER_OBS, q, obs, STYLE_OBS, false);
	if (q == OB_PAPER_STEP)
		add_experiments(c, m->here, OB_PAPER_OBS, OB_PAPER_ONE, "OBS: CPU of one simulator", STYLE_ONE, false);
	else
		add_experiments(c, m->here, OB_PAPER_POOL, q, "OBS, one thread a core", STYLE_POOL, false);
	add_experiments(c, &m->paper, OB_PAPER_COMMON, q, "common, as printed in the paper", STYLE_COMMON, true);
	add_experiments(c, &m->paper, OB_PAPER_OBS, q, "OBS, as printed in the paper", STYLE_OBS, true);
	c->plot.x.label = "experiment";
	OB_SAY(c->subtitle, "here: %u boxes, other sizes and attitudes in each experiment; %s", m->here->objects,
	       m->here->machine);
}

static void draw_fit(ob_paper_chart *c, const ob_line *l, bool logarithmic, double from, double to, const char *label)
{
	double scale = 100;
	begin(c, NULL, STYLE_GUIDE, false);
	for (int i = 0; i <= CURVE; i++) {
		double x = from + (to - from) * i / CURVE;
		double y = l->intercept + l->slope * (logarithmic ? log(x) : x);
		add(c, x, y * scale, i == CURVE ? label : NULL);
	}
}

static void draw_growth(ob_paper_chart *c, const ob_paper_matter *m, int chart)
{
	ob_paper_quantity q = charts[chart].quantity;
	ob_paper_scenario s = charts[chart].scenario;
	double from = INFINITY, to = 0;
	begin(c, ob_paper_setups[s].title, s == OB_PAPER_OBS ? STYLE_OBS : STYLE_COMMON, false)->line = false;
	for (size_t i = 0; i < m->here->count; i++) {
		const ob_paper_sample *at = &m->here->sample[i];
		if (!at->growth || at->scenario != s || *at->failed)
			continue;
		add(c, at->objects, ob_paper_value(at, q) * ob_paper_quantities[q].scale, NULL);
		from = fmin(from, at->objects);
		to = fmax(to, at->objects);
	}
	ob_paper_growth g = ob_paper_grow(m->here, s, q);
	if (g.linear.n < 3 || !(to > from))
		return;
	draw_fit(c, &g.linear, false, from, to, "line");
	draw_fit(c, &g.logarithmic, true, from, to, "logarithm");
	int prefers = ob_paper_prefers(&g);
	OB_SAY(c->subtitle, "least squares: a + b n with b = %s (%s to %s) an object, a + b ln n; the data prefer %s",
	       ob_word_value(g.linear.slope, q).text, ob_word_value(g.linear.slope_low, q).text,
	       ob_word_value(g.linear.slope_high, q).text,
	       prefers > 0   ? "the line"
	       : prefers < 0 ? "the logarithm"
			     : "neither");
	if (prefers)
		OB_SAY(c->subtitle, ", %s", ob_word_odds(g.favour).text);
	c->plot.x.label = "objects n";
}

ob_paper_chart *ob_paper_chart_make(const ob_paper_matter *m, int chart)
{
	const ob_paper_quantity_def *def = &ob_paper_quantities[charts[chart].quantity];
	ob_paper_chart *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	OB_SAY(c->title, "%s", charts[chart].caption);
	OB_SAY(c->y_label, "%s (%s)", charts[chart].quantity == OB_PAPER_STEP ? "runtime" : def->title, def->unit);
	c->plot = (ob_plot){ .title = c->title,
			     .subtitle = c->subtitle,
			     .y = { .label = c->y_label, .scale = charts[chart].scale },
			     .series = c->series };
	if (charts[chart].growth)
		draw_growth(c, m, chart);
	else
		draw_experiments(c, m, charts[chart].quantity);
	if (c->plot.series_count > 0 && c->plot.x.label)
		return c;
	free(c);
	return NULL;
}

const ob_plot *ob_paper_chart_plot(const ob_paper_chart *c)
{
	return &c->plot;
}

void ob_paper_chart_free(ob_paper_chart *c)
{
	free(c);
}
