// Islands: the objects that touch each other, directly or through others, or are expected to within the next step. An
// island is the unit of work and of synchronisation.
#ifndef OB_SIM_ISLAND_BUILDER_H
#define OB_SIM_ISLAND_BUILDER_H

#include "table/table.h"

// Groups the objects that are due (ob_schedule.due), and what they touch or are expected to, into islands and the islands
// into chunks of about equal work, largest first. Islands that an awake object touches, or is expected to, wake up.
void ob_islands_plan(ob_universe *u);
// Within the step, after some pairs have met across islands (sim/meeting.h): makes one island of those that did. The
// others stand as they were solved; the chunks are of what must be solved again.
void ob_islands_merge(ob_universe *u);

#endif
