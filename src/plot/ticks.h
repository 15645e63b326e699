// Where an axis has its ticks, and how they are labelled: steps of 1-2-5, decades, or powers of two. Pure; any thread.
#ifndef OB_PLOT_TICKS_H
#define OB_PLOT_TICKS_H

#include "plot/plot.h"

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

// Ticks for the values from .. to, about "wanted" of them with labels. With "fixed" the axis begins and ends just
// there; else it is made wider, so that nothing lies on its rim. Logarithmic: both > 0. from <= to, both finite.
void ob_ticks_choose(ob_ticks *t, ob_plot_scale scale, double from, double to, int wanted, bool fixed);

// Where a value lies: 0 = beginning, 1 = end of the axis. Logarithmic: v > 0.
double ob_ticks_along(const ob_ticks *t, double v);

#endif
