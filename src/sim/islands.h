// Islands: the objects that may touch each other, directly or through others, within the next step. What happens in
// one island is nobody else's business, so an island is the unit of work and of synchronisation.
#ifndef OB_SIM_ISLANDS_H
#define OB_SIM_ISLANDS_H

#include "table/table.h"

// Groups the awake objects into islands and the islands into chunks of about equal work, largest first. Islands that
// an awake object may touch wake up. false: some objects must first look farther around (they are on the rebound list).
bool ob_islands_plan(ob_universe *u);

#endif
