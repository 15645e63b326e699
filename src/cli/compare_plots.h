// The diagrams of a comparison.
#ifndef OB_CLI_COMPARE_PLOTS_H
#define OB_CLI_COMPARE_PLOTS_H

#include "cli/compare.h"
#include "plot/plot.h"

enum { OB_DIAGRAM_POINTS = 256, OB_DIAGRAM_SERIES = 16 };

typedef struct ob_diagram {
	const char *name; // of its files
	ob_plot plot;
	char title[160], subtitle[1024];
	char category_text[OB_WAYS][64];
	const char *category[OB_WAYS];
	size_t points;
	ob_plot_point point[OB_DIAGRAM_POINTS];
	char hint[OB_DIAGRAM_POINTS][128];
	ob_plot_series series[OB_DIAGRAM_SERIES];
	size_t series_count;
} ob_diagram;

// d->series_count is 0 where there is nothing to show.
void ob_diagram_cost(ob_diagram *d, const ob_comparison *c, const ob_section *s); // CPU per body and step, all ways
void ob_diagram_latency(ob_diagram *d, const ob_comparison *c, const ob_section *s); // of a step, all ways
void ob_diagram_growth(ob_diagram *d, const ob_comparison *c); // cost over the number of objects

#endif
