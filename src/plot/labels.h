// Labels within the data: of targets and of points, where there is room for them. One thread at a time.
#ifndef OB_PLOT_LABELS_H
#define OB_PLOT_LABELS_H

#include "plot/frame.h"

// After the curves: what they have noted is not covered. false: no memory.
bool ob_labels_draw(ob_frame *f, ob_drawing *d);

#endif
