// The data themselves: target lines, curves, markers, error bars, crosses. One thread at a time.
#ifndef OB_PLOT_CURVES_H
#define OB_PLOT_CURVES_H

#include "plot/frame.h"

// px from .. to of what a line joins, cut to the frame; false: nothing of it is inside
bool ob_curves_cut(ob_rect r, ob_dot *from, ob_dot *to);

void ob_curves_tints(const ob_frame *f, ob_drawing *d); // behind the axes
// All but the tints. Notes what labels must not cover.
bool ob_curves_draw(ob_frame *f, ob_drawing *d); // false: no memory

#endif
