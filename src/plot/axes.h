// Axes: what surrounds the data, and what lies behind them. One thread at a time.
#ifndef OB_PLOT_AXES_H
#define OB_PLOT_AXES_H

#include "plot/frame.h"

// px that the labels of y need at the left, and those of x beyond the right end
double ob_axes_left(const ob_frame *f, double width);
double ob_axes_right(const ob_frame *f);
extern const double ob_axes_bottom; // px below the frame

void ob_axes_bands(const ob_frame *f, ob_drawing *d); // behind all else
void ob_axes_draw(const ob_frame *f, ob_drawing *d);

#endif
