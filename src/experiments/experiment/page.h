// HTML output of all reports: templates with slots, escaped texts, one style and one script, which draws
// the diagrams. A page needs no other file and no network. One thread at a time per page.
#ifndef OB_EXPERIMENT_PAGE_H
#define OB_EXPERIMENT_PAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "experiment/experiment.h"

typedef struct ob_page {
	FILE *out;
} ob_page;

// Value of {{name}} in a template.
typedef struct ob_page_slot {
	const char *name;
	void (*write)(ob_page *p, const void *with);
} ob_page_slot;

void ob_page_fill(ob_page *p, const char *template, const ob_page_slot *slot, size_t slots, const void *with);

typedef struct ob_report {
	const char *title, *style; // style: more of it, "" = none
	const char *body; // a template
	const ob_page_slot *slot;
	size_t slots;
} ob_report;

// Writes DIR/report.html, which replaces one that is there.
bool ob_report_write(const ob_report *r, const char *folder, const void *with, ob_error *e);

// printf of markup; the arguments must not need escaping.
void ob_page_markup(ob_page *p, const char *format, ...) __attribute__((format(printf, 2, 3)));
void ob_page_text(ob_page *p, const char *text);
// A paragraph; "" writes none. class: "" = none
void ob_page_paragraph(ob_page *p, const char *class, const char *text);
// Term of a list, and what it means; the name must not need escaping.
void ob_page_term(ob_page *p, const char *name, const char *text);

// Terms of a list: the machine and the program that the records are of. Returns the time that they took, s.
double ob_page_provenance(ob_page *p, const ob_records *r);
// Lists of the metrics' titles and meanings, with a heading above each group.
void ob_page_meanings(ob_page *p, const ob_metric *m, size_t count);

// ---- chart

// A diagram built point by point, and described in a page, whose script draws it (chart.js). It copies all texts, so they may
// come from anywhere. Any number is allowed; one that is not finite belongs to a failed point, or to none. One thread at a
// time per chart.

enum { OB_CHART_SERIES = 72, OB_CHART_CATEGORIES = 64 };

typedef enum ob_chart_scale {
	OB_SCALE_LINEAR,
	OB_SCALE_LOG, // values of zero or less lie in a band of their own at the lower rim, named "0"
	OB_SCALE_LOG2 // ticks at powers of two
} ob_chart_scale;

typedef struct ob_chart_axis {
	char label[128]; // with its unit: "CPU per body and simulated second (us)"
	ob_chart_scale scale;
} ob_chart_axis;

typedef struct ob_chart_point {
	double x, y;
	double low, high; // error bar in y; NAN: none
	bool failed; // drawn as a cross; in a band at the rim if x or y is not finite
	char label[32]; // next to the marker, if there is room
	char hint[192]; // tooltip; "" = the series, the label and the values
} ob_chart_point;

typedef struct ob_chart_series {
	char title[128]; // "" = not in the legend
	// colour, marker and dash of the palette; the same in every diagram. 0 is drawn boldest and on top; negative: a
	// grey guide without markers
	int style;
	bool line; // joins successful points
	bool hollow; // open markers, finely dotted line: same subject with another setting
	size_t first, count; // its points
} ob_chart_series;

typedef struct ob_chart_mark {
	double at;
	char label[64]; // "target"
	bool vertical; // line at x = at; otherwise at y = at
	bool tinted; // tint the desirable side, below or left of the line
} ob_chart_mark;

typedef struct ob_chart {
	char name[96]; // of the file as which a reader saves it
	char title[160], subtitle[640]; // the subtitle carries the configuration
	ob_chart_axis x, y;
	size_t categories; // not 0: y is 0, 1, .. for these, downwards
	char category[OB_CHART_CATEGORIES][96];
	size_t marks;
	ob_chart_mark mark[2];
	double width, height; // px; 0 = 760 x 480; a legend below, or long titles, make it higher
	size_t series_count, points, points_max;
	ob_chart_series series[OB_CHART_SERIES];
	ob_chart_point *point;
} ob_chart;

ob_chart *ob_chart_new(void); // ends the program if memory runs out
void ob_chart_free(ob_chart *c);
// Begins a series; points are added to the last one. Empty series are left out. title "" = not in the legend
ob_chart_series *ob_chart_begin(ob_chart *c, int style, bool hollow, const char *title);
// Adds a point, which may be changed until the next is added. label, hint "" = none
ob_chart_point *ob_chart_add(ob_chart *c, double x, double y, const char *label, const char *hint);

// Writes the figure of a page, with a caption unless it is "", and frees c. An empty chart (NULL, or no points) is none.
void ob_chart_html(ob_chart *c, ob_page *p, const char *caption);

#endif
