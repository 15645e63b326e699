// The paper's figures, with ours added.
#include <math.h>

#include "paper/report.h"
#include "paper/words.h"

enum { CURVE = 60 }; // points of a fitted line
enum { STYLE_OBS = 0, STYLE_POOL = 1, STYLE_ONE = 2, STYLE_COMMON = 5, STYLE_GUIDE = -1 };

static const struct {
	const char *name, *caption;
	ob_paper_metric metric;
	bool growth;
	ob_paper_scenario scenario; // of growth
	ob_chart_scale scale;
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

static void add_experiments(ob_chart *c, const ob_paper_results *r, ob_paper_scenario s, ob_paper_metric m,
			    const char *title, int style, bool hollow)
{
	ob_chart_begin(c, style, hollow, title);
	for (uint32_t k = 0; k < r->experiments; k++) {
		const ob_record *at = ob_paper_find(r, s, k);
		if (at && isfinite(at->metric[m]))
			ob_chart_add(c, k + 1, at->metric[m] * ob_paper_metrics[m].scale, "", "");
	}
}

static void draw_experiments(ob_chart *c, const ob_paper_report_model *model, ob_paper_metric m)
{
	const ob_paper_results *here = model->here;
	const bool step = m == OB_PAPER_STEP;
	add_experiments(c, here, OB_PAPER_COMMON, m, step ? "common: the step" : "common", STYLE_COMMON, false);
	add_experiments(c, here, OB_PAPER_OBS, m,
			step ? "OBS, one process an object: the step" : "OBS, one process an object", STYLE_OBS, false);
	if (step)
		add_experiments(c, here, OB_PAPER_OBS, OB_PAPER_ONE, "OBS: CPU of one simulator", STYLE_ONE, false);
	else
		add_experiments(c, here, OB_PAPER_POOL, m, "OBS, one thread a core", STYLE_POOL, false);
	add_experiments(c, &model->paper, OB_PAPER_COMMON, m, "common, as printed in the paper", STYLE_COMMON, true);
	add_experiments(c, &model->paper, OB_PAPER_OBS, m, "OBS, as printed in the paper", STYLE_OBS, true);
	OB_SAY(c->x.label, "experiment");
	OB_SAY(c->subtitle, "here: %u boxes, other sizes and attitudes in each experiment; %s", here->objects,
	       here->records.machine);
}

static void draw_fit(ob_chart *c, const ob_line *l, bool logarithmic, double from, double to, double scale,
		     const char *label)
{
	ob_chart_begin(c, STYLE_GUIDE, false, "");
	for (int i = 0; i <= CURVE; i++) {
		double x = from + (to - from) * i / CURVE;
		double y = l->intercept + l->slope * (logarithmic ? log(x) : x);
		ob_chart_add(c, x, y * scale, i == CURVE ? label : "", "");
	}
}

static void draw_growth(ob_chart *c, const ob_paper_report_model *model, int chart)
{
	const ob_paper_metric m = charts[chart].metric;
	const ob_paper_scenario s = charts[chart].scenario;
	const double scale = ob_paper_metrics[m].scale;
	double from = INFINITY, to = 0;
	ob_chart_begin(c, s == OB_PAPER_OBS ? STYLE_OBS : STYLE_COMMON, false, ob_paper_setups[s].title)->line = false;
	for (size_t i = 0; i < model->here->records.count; i++) {
		const ob_record *at = &model->here->records.record[i];
		uint32_t objects;
		if (!ob_paper_is_growth(at->of, &objects) || ob_paper_scenario_of(at) != s || at->failure ||
		    !isfinite(at->metric[m]))
			continue;
		ob_chart_add(c, objects, at->metric[m] * scale, "", "");
		from = fmin(from, objects);
		to = fmax(to, objects);
	}
	ob_paper_growth g = ob_paper_grow(model->here, s, m);
	OB_SAY(c->x.label, "objects n");
	if (g.linear.n < 3 || !(to > from))
		return;
	draw_fit(c, &g.linear, false, from, to, scale, "line");
	draw_fit(c, &g.logarithmic, true, from, to, scale, "logarithm");
	int prefers = ob_paper_prefers(&g);
	OB_SAY(c->subtitle, "least squares: a + b n with b = %s (%s to %s) an object, a + b ln n; the data prefer %s",
	       ob_word_value(g.linear.slope, m).text, ob_word_value(g.linear.slope_low, m).text,
	       ob_word_value(g.linear.slope_high, m).text,
	       prefers > 0   ? "the line"
	       : prefers < 0 ? "the logarithm"
			     : "neither");
	if (prefers)
		OB_SAY(c->subtitle, ", %s", ob_word_odds(g.favour).text);
}

ob_chart *ob_paper_chart_make(const ob_paper_report_model *model, int chart)
{
	const ob_paper_metric m = charts[chart].metric;
	ob_chart *c = ob_chart_new();
	OB_SAY(c->name, "%s", charts[chart].name);
	OB_SAY(c->title, "%s", charts[chart].caption);
	OB_SAY(c->y.label, "%s (%s)", m == OB_PAPER_STEP ? "runtime" : ob_paper_metrics[m].title,
	       ob_paper_metrics[m].unit);
	c->y.scale = charts[chart].scale;
	if (charts[chart].growth)
		draw_growth(c, model, chart);
	else
		draw_experiments(c, model, m);
	return c;
}
