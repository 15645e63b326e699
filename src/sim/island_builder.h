// Islands: the objects that touch each other, directly or through others, or are expected to within the next step. An
// island is the unit of work and of synchronisation.
#ifndef OB_SIM_ISLAND_BUILDER_H
#define OB_SIM_ISLAND_BUILDER_H

#include "sim/halo.h"
#include "sim/regions.h"

enum { OB_ISLANDS_MANY = 256 }; // bodies that are due: for fewer the gate would cost more than other workers gain
enum { OB_ISLANDS_AT_ONCE = 32 }; // of which something is listed, or published: some ten us

// Groups the objects that are due (ob_schedule.due), and those that they touch or are expected to, into islands, and
// the islands into chunks of about equal work, largest first; of several ranks, into one for each simulator. Islands
// that an awake object touches, or is expected to, wake.
//
//   begin ──> link .. link ──> list members ──> list pairs .. list pairs ──> deal
//             tasks, each once          ^       tasks, each once
//                              merge ───┘
//
// By the scheduling worker. Tasks in any order; by several workers at the same time if each object is a root
// (ob_step_counts.rooted), as it is where many are due. The islands are the same, and so are their orders of members
// and pairs.
void ob_islands_begin(ob_universe *u); // who is due
uint32_t ob_islands_link_tasks(const ob_universe *u);
void ob_islands_link(ob_universe *u, uint32_t task); // whom they are linked to
void ob_islands_list_members(ob_universe *u);
uint32_t ob_islands_list_tasks(const ob_universe *u);
void ob_islands_list_pairs(ob_universe *u, uint32_t task);
// regions: of several ranks; NULL: there is but one.
void ob_islands_deal(ob_universe *u, ob_regions *regions);
// Of several ranks, after that, for there are no tasks that list pairs: those of the islands of this one's simulators.
// halo: is told which bodies are at borders.
void ob_islands_list_own_pairs(ob_universe *u, ob_halo *halo);
// Within the step, after late contacts (sim/late_contacts.h): merges the islands that they join, and lists members. The
// solutions of the others stand, and so do their lists, and what is known of pairs that have nothing to do with those;
// the chunks hold what must be solved again.
void ob_islands_merge(ob_universe *u);
// A chunk of so much work is closed, where that is all the work that so many workers share.
uint64_t ob_islands_chunk_work(uint64_t total, uint32_t workers);

#endif
