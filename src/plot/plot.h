// Diagrams: axes with units, curves, markers, a legend; drawn by cairo into SVG and PNG from one description.
// Pure but for the files that it writes; any thread.
#ifndef OB_PLOT_PLOT_H
#define OB_PLOT_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

typedef enum ob_scale { OB_SCALE_LINEAR, OB_SCALE_LOG } ob_scale;

typedef struct ob_plot_axis {
	const char *label; // with its unit: "CPU per body and simulated second (us)"
	ob_scale scale;
	double from, to; // both 0: chosen from the data
} ob_plot_axis;

typedef struct ob_plot_point {
	double x, y;
	double low, high; // error bar in y; both 0: none
	bool failed; // drawn as a cross, at the upper rim where y is not finite
	const char *label; // next to the marker, where there is room; NULL = none
} ob_plot_point;

typedef struct ob_plot_series {
	const char *title;
	size_t count;
	const ob_plot_point *point;
	int style; // colour, marker and dash of the palette; the same number looks the same in every plot
	bool line; // joins the points that did not fail
} ob_plot_series;

typedef struct ob_plot_mark {
	double at;
	bool vertical; // a line at x = at, else at y = at
	const char *label; // "target"
} ob_plot_mark;

typedef struct ob_plot {
	const char *title, *subtitle; // the subtitle carries the configuration
	ob_plot_axis x, y;
	size_t series_count, marks;
	const ob_plot_series *series;
	const ob_plot_mark *mark;
	double width, height; // px; 0 = 760 x 480
} ob_plot;

bool ob_plot_svg(const ob_plot *p, const char *path, ob_error *e);
bool ob_plot_png(const ob_plot *p, const char *path, double zoom, ob_error *e);
// The SVG as a string, to be put into a page; free() it. NULL and e: no memory.
char *ob_plot_svg_text(const ob_plot *p, ob_error *e);

#endif
