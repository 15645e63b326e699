// The frame of reference that an island is solved in. What falls together feels nothing of it, and what stands on a
// lift feels it as weight: an island is solved as seen by who speeds up with what holds it, and how far that has come
// is added in the end.
#ifndef OB_SIM_FRAME_H
#define OB_SIM_FRAME_H

#include "sim/state.h"

// Bodies are loaded, as seen from the world: finds what holds them, and from then on accelerations are those of the
// frame. Sets max_acceleration, which they feel.
void ob_frame_enter(ob_sim *s, const ob_island *is);
// After the last substep: back to the world's.
void ob_frame_leave(ob_sim *s);

#endif
