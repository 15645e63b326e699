// Geometry of a diagram: the range of each axis, the area of the data, the bands at its rims, and every point in
// pixels.
//
//      +----------------------------------------------+
//      | high band of y: points whose y is not finite |     Bands exist only if points lie in them; x has
//      +----------------------------------------------+     its own, left (zero) and right (not finite).
//      |                                              |
//      | area                                         |
//      |                                              |
//      +----------------------------------------------+
//      | low band of y: zero, on a logarithmic axis   |
//      +----------------------------------------------+
//
// One thread at a time per frame; the functions of ticks are pure.
#ifndef OB_PLOT_FRAME_H
#define OB_PLOT_FRAME_H

#include "plot/drawing.h"

// ---- ticks of an axis and their labels: steps of 1-2-5, decades, or powers of two

enum { OB_TICKS_MAX = 160 };

typedef struct ob_tick {
	double at; // along the axis: 0 = its beginning, 1 = its end
	bool major; // labelled, and with a line of the grid
	char text[20], super[8]; // the label, and its exponent
} ob_tick;

typedef struct ob_ticks {
	ob_plot_scale scale;
	double from, to; // transformed: of ob_ticks_along
	size_t count;
	ob_tick tick[OB_TICKS_MAX];
} ob_ticks;

// Chooses ticks for the values from .. to, about "wanted" of them with labels. With "fixed" the axis has exactly this
// range; otherwise it is wider, so that nothing lies on its rim. Logarithmic: both > 0. from <= to, both finite.
void ob_ticks_choose(ob_ticks *t, ob_plot_scale scale, double from, double to, int wanted, bool fixed);

// Position of a value: 0 = beginning, 1 = end of the axis. Logarithmic: v > 0.
double ob_ticks_along(const ob_ticks *t, double v);

// ---- frame

enum { OB_FRAME_LANES = 6 }; // points side by side across a band

// A band at a rim: its points lie in lanes, so that they do not cover each other.
typedef struct ob_band {
	bool used;
	int lanes;
} ob_band;

typedef struct ob_side {
	const ob_plot_axis *axis;
	bool vertical;
	double least, most; // range of the data on the axis proper
	bool fixed; // the plot sets its range
	ob_ticks ticks;
	double begin, end; // px, beginning and end of the range, without bands; vertical: begin > end
	ob_band low, high;
} ob_side;

typedef struct ob_spot {
	const ob_plot_series *series;
	const ob_plot_point *point;
	ob_dot at;
	bool shown;
} ob_spot;

typedef struct ob_frame {
	const ob_plot *plot;
	ob_side x, y;
	ob_rect area, outer; // px: without and with the bands
	size_t spots; // points of all series in their order
	ob_spot *spot;
	bool failed; // at least one point is a cross
	size_t taken, taken_max; // texts and markers that labels must not cover
	ob_rect *take;
} ob_frame;

// Finds the ranges of the axes and the bands needed. Returns false if memory runs out.
bool ob_frame_begin(ob_frame *f, const ob_plot *p);
void ob_frame_finish(ob_frame *f);
// Puts the frame with its bands into "outer": ticks, areas, spots.
void ob_frame_place(ob_frame *f, ob_rect outer);

// px of a value along an axis; in lane 0 of its band, if it lies in one. Values beyond a range lie beyond the area.
double ob_frame_at(const ob_side *s, double value);
// px of a target; at the inner rim of its band, if it lies in one, as the whole band is beyond it
double ob_frame_mark(const ob_side *s, double value);
// px: the inner and the outer rim of a band
void ob_frame_band(const ob_side *s, bool high, double *inner, double *outer);
bool ob_frame_logarithmic(const ob_side *s);
bool ob_frame_take(ob_frame *f, ob_rect r); // false: no memory

#endif
