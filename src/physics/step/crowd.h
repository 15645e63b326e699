// Objects to blame where there is no room for pairs of neighbours, or where all shares of a step together are too much.
#ifndef OB_STEP_CROWD_H
#define OB_STEP_CROWD_H

#include "table/table.h"

// Host, paused, after such a failure: lists the objects that are frozen for it: the one with most pairs first, and those that
// have at least half as many. Writes at most "most" ids; returns their number.
uint32_t ob_crowd(const ob_universe *u, uint32_t *ids, uint32_t most);

// The scheduling worker, when a phase of a run that freezes has ended: fails the step if its shares together took more than it
// may, and gives up those to be frozen. solved: islands were; then it is those that cost at least half as much as the dearest,
// else objects with at least half as many pairs as the most crowded one.
void ob_crowd_limit_work(ob_universe *u, bool solved);

#endif
