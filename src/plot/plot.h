// Diagrams: axes with units, curves, markers, a legend; as SVG and (painted by cairo) PNG from one description. The
// same description gives the same bytes. Pure except for the files that it writes; any thread.
//
// Texts are UTF-8. Any number is allowed. On a logarithmic axis, values of zero or less lie in a band of their own at
// the lower rim, named "0"; an axis without values gets a default range.
//
// A page that includes the SVG can override its colours: items have the classes f-NAME (fill) and s-NAME (stroke),
// where NAME is paper, ink, muted, grid, band, good, meadow or c0 .. c7 (series).
#ifndef OB_PLOT_PLOT_H
#define OB_PLOT_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <ob/error.h>

typedef enum ob_plot_scale {
	OB_SCALE_LINEAR,
	OB_SCALE_LOG,
	OB_SCALE_LOG2, // ticks at powers of two
	OB_SCALE_CATEGORY // y alone: 0, 1, .. are the names of ob_plot_axis.category, downwards
} ob_plot_scale;

typedef struct ob_plot_axis {
	const char *label; // with its unit: "CPU per body and simulated second (us)"
	ob_plot_scale scale;
	double from, to; // both 0: chosen from the data
	size_t categories; // OB_SCALE_CATEGORY
	const char *const *category;
} ob_plot_axis;

typedef struct ob_plot_point {
	double x, y;
	double low, high; // error bar in y; both 0: none
	bool failed; // drawn as a cross; in a band at the rim if x or y is not finite
	const char *label; // next to the marker, if there is room; NULL = none
	const char *hint; // tooltip in a browser; NULL = the series, the label and the values
} ob_plot_point;

typedef struct ob_plot_series {
	const char *title; // NULL: not in the legend
	size_t count;
	const ob_plot_point *point;
	// colour, marker and dash of the palette; the same in every plot. 0 is drawn boldest and on top; negative: a
	// grey guide without markers
	int style;
	bool line; // joins successful points
	bool hollow; // open markers, finely dotted line: same subject with another setting
} ob_plot_series;

typedef struct ob_plot_mark {
	double at;
	bool vertical; // line at x = at; otherwise at y = at
	const char *label; // "target"; NULL = none
	bool tinted; // tint the desirable side, below or left of the line
} ob_plot_mark;

typedef struct ob_plot {
	const char *title, *subtitle; // the subtitle carries the configuration
	ob_plot_axis x, y;
	size_t series_count, marks;
	const ob_plot_series *series;
	const ob_plot_mark *mark;
	double width, height; // px; 0 = 760 x 480; a legend below, or long titles, make it higher
} ob_plot;

// True if PNG can be painted: cairo is there. false and e with the package that is missing. Maps nothing.
bool ob_plot_check(ob_error *e);
bool ob_plot_svg(const ob_plot *p, const char *path, ob_error *e);
bool ob_plot_png(const ob_plot *p, const char *path, double zoom, ob_error *e);
// Returns the SVG as a string for a page; free() it. NULL and e: out of memory.
char *ob_plot_svg_text(const ob_plot *p, ob_error *e);

#endif
