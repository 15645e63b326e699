#include "cli/compare_plots.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/version.h"

static ob_plot_series *begin(ob_diagram *d, const char *title, int style)
{
	ob_plot_series *s = &d->series[d->series_count++];
	*s = (ob_plot_series){ .title = title, .point = &d->point[d->points], .style = style };
	return s;
}

static ob_plot_point *add(ob_diagram *d, double x, double y, const char *hint)
{
	ob_plot_point *p = &d->point[d->points];
	snprintf(d->hint[d->points++], sizeof *d->hint, "%s", hint);
	*p = (ob_plot_point){ .x = x, .y = y, .hint = d->hint[p - d->point] };
	d->series[d->series_count - 1].count++;
	return p;
}

static void start(ob_diagram *d, const ob_comparison *c, const char *define, const char *name)
{
	memset(d, 0, sizeof *d);
	d->name = name;
	snprintf(d->subtitle, sizeof d->subtitle, "%s %s%s; %" PRIu32 " runs of each, medians; %s; %s", c->scene,
		 define, c->options, c->repeats, c->machine, ob_version_commit);
	d->plot = (ob_plot){ .title = d->title, .subtitle = d->subtitle, .series = d->series };
}

// The ways that ran, downwards; returns how many.
static int list_ways(ob_diagram *d, const ob_comparison *c, const ob_section *s, int way[OB_WAYS])
{
	int n = 0;
	for (int w = 0; w < OB_WAYS; w++) {
		if (!ob_cell_is_done(s, w))
			continue;
		snprintf(d->category_text[n], sizeof *d->category_text, "%s%s%s", ob_way_table[w].title,
			 ob_way_table[w].other_narrow ? ", " : "", ob_way_table[w].other_narrow ? c->other : "");
		d->category[n] = d->category_text[n];
		way[n++] = w;
	}
	d->plot.y = (ob_plot_axis){
		.label = "", .scale = OB_SCALE_CATEGORY, .categories = (size_t)n, .category = d->category
	};
	d->plot.height = 130 + 42 * n;
	return n;
}

void ob_diagram_cost(ob_diagram *d, const ob_comparison *c, const ob_section *s)
{
	int way[OB_WAYS];
	start(d, c, s->define, "cost");
	int ways = list_ways(d, c, s, way);
	snprintf(d->title, sizeof d->title, "What a step of a body costs, %" PRIu32 " objects", s->objects);
	d->plot.x = (ob_plot_axis){ .label = "CPU per body and step (\u00b5s)", .scale = OB_SCALE_LOG };
	for (int i = 0; i < ways; i++) { // the interval as a line behind the marker
		ob_spread x = ob_spread_of(&s->cell[way[i]], OB_FIGURE_COST);
		begin(d, NULL, -1)->line = true;
		add(d, 1e6 * x.low, i, "");
		add(d, 1e6 * x.high, i, "");
	}
	if (ways)
		begin(d, "median; the line runs from the lower to the upper bound", 0);
	for (int i = 0; i < ways; i++) {
		char hint[128];
		ob_spread x = ob_spread_of(&s->cell[way[i]], OB_FIGURE_COST);
		snprintf(hint, sizeof hint, "%s: %.3g \u00b5s (%.3g to %.3g)", d->category[i], 1e6 * x.median,
			 1e6 * x.low, 1e6 * x.high);
		add(d, 1e6 * x.median, i, hint);
	}
	d->plot.series_count = d->series_count;
}

void ob_diagram_latency(ob_diagram *d, const ob_comparison *c, const ob_section *s)
{
	static const struct {
		ob_figure figure;
		const char *title;
	} lines[] = { { OB_FIGURE_P50, "median" },
		      { OB_FIGURE_P90, "90 %" },
		      { OB_FIGURE_P99, "99 %" },
		      { OB_FIGURE_MAX, "longest" } };
	int way[OB_WAYS];
	start(d, c, s->define, "latency");
	int ways = list_ways(d, c, s, way);
	snprintf(d->title, sizeof d->title, "How long a step takes, %" PRIu32 " objects", s->objects);
	d->plot.x = (ob_plot_axis){ .label = "wall-clock time of a step (ms)", .scale = OB_SCALE_LOG };
	for (int k = 0; k < 4 && ways; k++) {
		begin(d, lines[k].title, k);
		for (int i = 0; i < ways; i++) {
			char hint[128];
			double ms = 1e3 * ob_spread_of(&s->cell[way[i]], lines[k].figure).median;
			snprintf(hint, sizeof hint, "%s, %s: %.3g ms", d->category[i], lines[k].title, ms);
			add(d, ms, i, hint);
		}
	}
	d->plot.series_count = d->series_count;
}

void ob_diagram_growth(ob_diagram *d, const ob_comparison *c)
{
	start(d, c, "", "growth");
	snprintf(d->title, sizeof d->title, "What a step of a body costs, by the number of objects");
	d->plot.x = (ob_plot_axis){ .label = "objects", .scale = OB_SCALE_LOG };
	d->plot.y = (ob_plot_axis){ .label = "CPU per body and step (\u00b5s)", .scale = OB_SCALE_LOG };
	for (int w = 0; w < OB_WAYS && c->sections > 1; w++) {
		if (ob_way_table[w].other_narrow)
			continue;
		begin(d, ob_way_table[w].title, w)->line = true;
		for (uint32_t i = 0; i < c->sections; i++) {
			ob_spread x = ob_spread_of(&c->section[i].cell[w], OB_FIGURE_COST);
			if (isnan(x.median))
				continue;
			char hint[128];
			snprintf(hint, sizeof hint, "%s, %" PRIu32 " objects: %.3g \u00b5s", ob_way_table[w].title,
				 c->section[i].objects, 1e6 * x.median);
			ob_plot_point *p = add(d, c->section[i].objects, 1e6 * x.median, hint);
			p->low = 1e6 * x.low;
			p->high = 1e6 * x.high;
		}
		if (d->series[d->series_count - 1].count == 0)
			d->series_count--;
	}
	d->plot.series_count = d->series_count;
}
