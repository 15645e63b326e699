// How much of a substep is made at once. Where fast bodies touch, and their contact's geometry would not hold to the
// substep's end, the substep is made in strides; and a stride ends when something fast meets something else, so that the
// next begins with their contact as it is then.
#ifndef OB_SIM_PACE_H
#define OB_SIM_PACE_H

#include "sim/state.h"

// Chooses the length of the next stride, at most "left" (s), sets it in the island, and scales to it what was predicted
// for the last one.
void ob_adaptive_begin(ob_sim *s, double left);
// s: no stride is shorter, but the last of a substep.
double ob_adaptive_shortest(const ob_island_work *w);
// After a look, and after impacts: ends the stride where something that turns rebounds next, so that another begins with its impact.
void ob_adaptive_end_at_rebound(ob_sim *s);
// After the exchanges: was something hit so that it is too fast now for the stride? Then the stride is shortened, and
// everything is as before the exchanges.
bool ob_adaptive_shorten(ob_sim *s);

#endif
