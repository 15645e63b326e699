// Adaptive partial substeps: how much of a substep is solved at once. Where fast bodies touch, and the geometry of
// their contact would not hold to the substep's end, the substep is divided; and a partial substep ends when a fast
// body reaches another, so that the next begins with their contact as it is then.
#ifndef OB_SIM_ADAPTIVE_SUBSTEP_H
#define OB_SIM_ADAPTIVE_SUBSTEP_H

#include "sim/state.h"

// Chooses the length of the next partial substep, at most "left" (s), sets it in the island (h, h_min), and scales to
// it the impulses that are the warm start.
void ob_adaptive_begin(ob_sim *s, double left);
// After the iterations: true if something was hit so that it is too fast now for the partial substep. Then that is made
// shorter, and everything is as before the iterations.
bool ob_adaptive_shorten(ob_sim *s);

#endif
