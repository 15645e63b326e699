// Assigns islands to ranks, of several (peers.h). Each rank finds the islands of its own bodies (island_builder.h), and
// most stay where they are. An island goes to another rank as a whole, before it is solved, if
//
//   - it is linked to another rank's island: they are one, and the rank with more of its work solves it;
//   - more of it is in another rank's region (regions.h), or one of its bodies was moved there (table/home.h);
//   - its rank would have a tenth more than its share of the work.
//
//   rank 0's bodies     rank 1's bodies
//   o-o   o-o-o . . . . o-o   o       . . .   a link: a joint, or a pair that is expected to touch, or has touched late.
//    A      B            C    D               All ranks know the few of two ranks' bodies; A and D concern their own.
// One message carries each rank's load, and for each body at such a link its island. From it all ranks find the same
// islands across borders (a forest of those alone), and the ranks with too much work. If any island moves, a second
// message carries it: its bodies' homes to all ranks, and to its new rank their motions (halo.h), and the contents of
// their pairs (holdings.h).
//
// The bits of a run do not depend on any of it.
//
// Thread-safety: the arranger alone calls these functions.
#ifndef OB_CLUSTER_RANK_ISLANDS_H
#define OB_CLUSTER_RANK_ISLANDS_H

#include "cluster/halo.h"
#include "cluster/holdings.h"
#include "cluster/regions.h"

// The parts of a rank's state that follow when islands move.
typedef struct ob_rank_parts {
	ob_halo *halo;
	ob_holdings *holdings;
	ob_regions *regions;
} ob_rank_parts;

// Link of two ranks' bodies.
typedef struct ob_rank_link {
	uint32_t a, b; // ids
} ob_rank_link;

typedef struct ob_rank_islands ob_rank_islands;

ob_rank_islands *ob_rank_islands_create(const ob_universe *u, const ob_rank_parts *parts); // NULL: no memory
void ob_rank_islands_destroy(ob_rank_islands *s); // NULL is allowed

// Moves islands between ranks. All ranks call it, when each has found the islands of its bodies and before it lists
// their members. link: [links], the same on all ranks. islands: set to true if any rank has any. false: the step has failed.
bool ob_rank_islands_share(ob_rank_islands *s, ob_universe *u, ob_peers *p, const ob_rank_link *link, uint32_t links,
			   bool *islands);

#endif
