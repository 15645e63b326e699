// Islands: the objects that touch each other, directly or through others, or are expected to within the next step. An
// island is the unit of work and of synchronisation.
#ifndef OB_SIM_ISLAND_BUILDER_H
#define OB_SIM_ISLAND_BUILDER_H

#include "sim/halo.h"
#include "sim/regions.h"

enum { OB_ISLANDS_MANY = 256 }; // bodies that are due: for fewer the gate would cost more than other workers gain
enum { OB_ISLANDS_AT_ONCE = 32 }; // of which something is listed, or published: some ten us

// Groups the objects that are due (ob_schedule.due), and those that they touch or are expected to, into islands, and
// the islands into chunks of about equal work, largest first; of several ranks each does so with its own bodies, a
// chunk for each of its simulators. Islands that an awake object touches, or is expected to, wake.
//
//   begin ──> link .. link ──> list members ──> list pairs .. list pairs ──> deal
//             tasks, each once    ^             tasks, each once
//                        merge ───┤
//                                 └── of several ranks: whole islands go from one to another (rank_islands.h)
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
// Of several ranks, after that, for there are no tasks that list pairs. halo: is told which bodies are at borders.
void ob_islands_list_dealt_pairs(ob_universe *u, ob_halo *halo);
// Within the step, after late contacts (sim/late_contacts.h): merges the islands that they join. The solutions of the
// others stand, and so do their lists, and what is known of pairs that have nothing to do with those; the chunks hold
// what must be solved again.
void ob_islands_merge(ob_universe *u);

// ---- of several ranks, before members are listed

// A body of this rank's is in an island, whether it is due or not: before those that it is linked to are found.
void ob_islands_involve(ob_universe *u, uint32_t id);
// The bodies that are in islands, in no order; returns how many. root: [object], of these, the one that its island is
// named by. Both hold until islands are dropped or joined.
uint32_t ob_islands_bodies(ob_universe *u, const uint32_t **body, const uint32_t **root);
// Islands that another rank solves. leaves: [object], not 0 = that of this name
void ob_islands_drop(ob_universe *u, const uint8_t *leaves);
// Two bodies, which are this rank's, are of one island, or the same is of one.
void ob_islands_join(ob_universe *u, uint32_t a, uint32_t b);
// So much work is a full share of all that so many have: beyond it others get what is too much.
uint64_t ob_islands_share(uint64_t total, uint32_t count);

// A chunk of so much work is closed, where that is all the work that so many workers share.
uint64_t ob_islands_chunk_work(uint64_t total, uint32_t workers);

#endif
