// The legend: outside of the data, at the right where there is room, else below. One thread at a time.
#ifndef OB_PLOT_LEGEND_H
#define OB_PLOT_LEGEND_H

#include "plot/frame.h"

typedef struct ob_legend {
	const ob_frame *frame;
	size_t entries; // 0: none is needed; the last is for the crosses where there are any
	bool below;
	double width, height; // px
} ob_legend;

// For a diagram of this width, the data of which are about "height" high
ob_legend ob_legend_plan(const ob_frame *f, double width, double height);
void ob_legend_draw(const ob_legend *l, ob_drawing *d, double x, double y);

#endif
