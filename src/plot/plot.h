// Diagrams: axes with units, curves, markers, a legend; as SVG and (painted by cairo) PNG from one description. The same
// description gives the same bytes. Pure but for the files that it writes; any thread.
//
// Texts are UTF-8. Any number is allowed: on a logarithmic axis what is zero or less lies in a band of its own at the
// lower rim, named "0", and an axis with nothing on it gets a range of its own.
//
// Colours of the SVG can be overruled by the page that it is put into: what is drawn has the classes f-NAME (fill) and
// s-NAME (stroke), where NAME is paper, ink, muted, grid, band, good, meadow or c0 .. c7 (series).
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
	bool failed; // drawn as a cross, in a band at the rim where x or y is not finite
	const char *label; // next to the marker, where there is room; NULL = none
	const char *hint; // shown by a browser under the pointer; NULL = the series, the label and the values
} ob_plot_point;

typedef struct ob_plot_series {
	const char *title; // NULL: not in the legend
	size_t count;
	const ob_plot_point *point;
	int style; // colour, marker and dash of the palette; the same number looks the same in every plot. 0 is drawn
	           // boldest and on top; negative: a grey guide without markers
	bool line; // joins the points that did not fail
	bool hollow; // markers not filled, the line finely dotted: the same thing, otherwise set
} ob_plot_series;

typedef struct ob_plot_mark {
	double at;
	bool vertical; // a line at x = at, else at y = at
	const char *label; // "target"; NULL = none
	bool tinted; // the side below it, or left of it, is where to be
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
// The SVG as a string, to be put into a page; free() it. NULL and e: no memory.
char *ob_plot_svg_text(const ob_plot *p, ob_error *e);

#endif
