// Objects to blame where there is no room for pairs of neighbours.
#ifndef OB_STEP_CROWD_H
#define OB_STEP_CROWD_H

#include "table/table.h"

// Host, paused, after such a failure: lists the objects that are frozen for it: the one with most pairs first, and those that
// have at least half as many. Writes at most "most" ids; returns their number.
uint32_t ob_crowd(const ob_universe *u, uint32_t *ids, uint32_t most);

#endif
