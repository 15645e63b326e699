// From a plot to a drawing. Pure; any thread.
#ifndef OB_PLOT_LAYOUT_H
#define OB_PLOT_LAYOUT_H

#include "plot/drawing.h"
#include "plot/plot.h"

// Fills d, which starts zeroed; ob_drawing_finish it in any case. false and e: no memory.
bool ob_plot_layout(const ob_plot *p, ob_drawing *d, ob_error *e);

#endif
