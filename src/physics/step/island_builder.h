// Islands: the objects that touch each other, directly or through others, or are expected to within the next step. An
// island is the unit of work and of synchronisation.
#ifndef OB_STEP_ISLAND_BUILDER_H
#define OB_STEP_ISLAND_BUILDER_H

#include "cluster/halo.h"
#include "cluster/regions.h"
#include "schedule/involved.h"

enum { OB_ISLANDS_MANY = 256 }; // due bodies; with fewer the gate costs more than other workers gain
enum { OB_ISLANDS_AT_ONCE = 32 }; // islands listed, or published, by one task: some ten us

// Groups the due objects (ob_schedule.due), and those that they touch or are expected to touch, into islands. Groups
// the islands into chunks of about equal work, largest first. Each of several ranks does so with its own bodies, a
// chunk for each of its simulators. Islands that an awake object touches, or is expected to touch, wake.
//
//   begin ──> link .. link ──> list members ──> list pairs .. list pairs ──> deal
//             tasks, each once    ^             tasks, each once
//                        merge ───┤
//                                 └── of several ranks: whole islands move between ranks (rank_islands.h)
//
// The scheduling worker calls them; tasks run in any order. Several workers run them at the same time if each object is
// a root (ob_step_counts.rooted), as it is where many are due. Islands, and their orders of members and pairs, are the
// same in any case.
void ob_islands_begin(ob_universe *u); // finds the due bodies
uint32_t ob_islands_link_tasks(const ob_universe *u);
void ob_islands_link(ob_universe *u, uint32_t task); // finds the bodies that they are linked to
void ob_islands_list_members(ob_universe *u);
uint32_t ob_islands_list_tasks(const ob_universe *u);
void ob_islands_list_pairs(ob_universe *u, uint32_t task);
// Deals the islands to workers. regions: of several ranks; NULL: there is but one.
void ob_islands_deal(ob_universe *u, ob_regions *regions);
// Lists the pairs after that, on several ranks, which have no tasks for it. halo: notes bodies at borders.
void ob_islands_list_dealt_pairs(ob_universe *u, ob_halo *halo);
// Merges the islands that late contacts join, within the step (step/late_contacts.h). Other islands keep their
// solutions, their lists, and the state of pairs that are not concerned. The chunks hold the islands to be solved
// again.
void ob_islands_merge(ob_universe *u);

// Work at which a chunk is closed, when so many workers share the total.
uint64_t ob_islands_chunk_work(uint64_t total, uint32_t workers);

#endif
