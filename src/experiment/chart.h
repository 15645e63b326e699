// A diagram built point by point, and written to files and into pages. It copies all texts, so they may come from
// anywhere. One thread at a time per chart.
#ifndef OB_EXPERIMENT_CHART_H
#define OB_EXPERIMENT_CHART_H

#include "experiment/page.h"
#include "plot/plot.h"

enum { OB_CHART_SERIES = 72, OB_CHART_CATEGORIES = 64 };

typedef struct ob_chart_text {
	char label[32], hint[192];
} ob_chart_text;

typedef struct ob_chart {
	ob_plot plot; // complete with its points after ob_chart_plot
	size_t points, points_max;
	ob_plot_point *point; // of all series
	ob_chart_text *text;
	size_t first[OB_CHART_SERIES]; // point of each series
	ob_plot_series series[OB_CHART_SERIES];
	char series_title[OB_CHART_SERIES][128];
	ob_plot_mark mark[2];
	const char *category[OB_CHART_CATEGORIES];
	char category_text[OB_CHART_CATEGORIES][96];
	char title[160], subtitle[640], x_label[128], y_label[128], mark_label[64];
} ob_chart;

ob_chart *ob_chart_new(void); // NULL: out of memory
void ob_chart_free(ob_chart *c);
// Begins a series; points are added to the last one. Empty series are left out. title "" = not in the legend
ob_plot_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title);
// Adds a point, which may be changed until the next is added. label, hint "" = none
ob_plot_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint);

// The finished diagram; NULL: it is empty.
const ob_plot *ob_chart_plot(ob_chart *c);
// Writes DIR/plots/NAME.svg and .png, and makes the folder. Frees c. An empty chart (NULL, or no points) is no error.
bool ob_chart_write(ob_chart *c, const char *dir, const char *name, ob_error *e);
// The same, under a name as "cost" or, for one point of a sweep (n=100), "cost-n-100". define: "" for none.
bool ob_chart_write_point(ob_chart *c, const char *dir, const char *of, const char *define, ob_error *e);
// Writes it as SVG into a page; frees c.
void ob_chart_html(ob_chart *c, ob_page *p);

#endif
