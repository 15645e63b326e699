// Islands: the objects that touch each other, directly or through others, or are expected to within the next step. An
// island is the unit of work and of synchronisation.
#ifndef OB_SIM_ISLAND_BUILDER_H
#define OB_SIM_ISLAND_BUILDER_H

#include "table/table.h"

// Groups the objects that are due (ob_schedule.due), and those that they touch or are expected to, into islands, and the
// islands into chunks of about equal work, largest first; of several ranks, into one for each simulator. Islands that an awake object touches, or is expected to, wake.
void ob_islands_build(ob_universe *u);
// Within the step, after late contacts (sim/late_contacts.h): merges the islands that they join. The solutions of the
// others stand; the chunks hold what must be solved again.
void ob_islands_merge(ob_universe *u);
// A chunk of so much work is closed, where that is all the work that so many workers share.
uint64_t ob_islands_chunk_work(uint64_t total, uint32_t workers);

#endif
