// The report's diagrams, made of results. One thread at a time per chart.
#ifndef OB_LAB_CHART_H
#define OB_LAB_CHART_H

#include "lab/digest.h"
#include "plot/plot.h"

enum { OB_CHART_SERIES = 3 * OB_DIGEST_ENGINES, OB_CHART_CASES = 64 };

typedef struct ob_chart_point_text {
	char label[32], hint[192];
} ob_chart_point_text;

typedef struct ob_chart {
	ob_plot plot;
	size_t points, points_max;
	ob_plot_point *point; // of all series
	ob_chart_point_text *text;
	ob_plot_series series[OB_CHART_SERIES];
	char series_title[OB_CHART_SERIES][128];
	ob_plot_mark mark[2];
	const char *category[OB_CHART_CASES];
	char category_text[OB_CHART_CASES][96];
	char title[160], subtitle[640], x_label[128], y_label[128], mark_label[64];
} ob_chart;

// NULL: there is nothing to show, or no memory. Each is to be given to ob_chart_free.
ob_chart *ob_chart_cost(const ob_digest *d, const ob_case *c); // error over cost, a curve an engine
ob_chart *ob_chart_convergence(const ob_digest *d, const ob_case *c); // error over substeps, with the observed order
ob_chart *ob_chart_promises(const ob_digest *d); // all cases: error over target, obsim beside other engines
ob_chart *ob_chart_ghost(const ob_digest *d); // all cases: neighbours of infinite mass
ob_chart *ob_chart_lag(const ob_digest *d); // error over how late partners are read
void ob_chart_free(ob_chart *c);

// for the files that make them
ob_chart *ob_chart_new(size_t points);
// A series of no points yet; points are added to the last one. title "" = not in the legend
ob_plot_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title);
ob_plot_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint);
// "60 Hz, 16 rounds, .." of the engines in a case (NULL: in the chart so far), and of the program; behind the subtitle
void ob_chart_configuration(ob_chart *c, const ob_digest *d, const ob_case *of);
// What a setting is called at its point: "8", "240 Hz", "0.5 mm"
void ob_chart_setting(const ob_result *r, char *to, size_t room);

#endif
