// The AABB query of a simulator: it publishes a fat AABB that holds its object for a while, and looks at those of others
// when its own or theirs have changed.
#ifndef OB_FREE_NEIGHBOURS_H
#define OB_FREE_NEIGHBOURS_H

#include "free/simulator.h"

// Renews the fat AABB if the step of length h (s) may leave it, and the list of neighbours.
void ob_free_neighbours_update(ob_free_sim *s, ob_free_scratch *x, double h);

#endif
