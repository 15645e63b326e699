// Which rank solves which island, of several (peers.h). Each finds those of its own bodies (island_builder.h), and most
// stay where they are; an island goes to another rank as a whole, before it is solved:
//
//   - it meets another rank's: they are one, and who has more of its work solves it;
//   - more of it is in another rank's region (regions.h), or one of its bodies was moved there (table/home.h);
//   - its rank would have a tenth more than its share of the work.
//
//   rank 0's bodies     rank 1's bodies
//   o-o   o-o-o . . . . o-o   o       . . .   a pair that is expected to touch, or has touched late: all ranks know
//    A      B            C    D               those of two ranks' bodies, which are few, and D and A are nobody else's
//
// One message tells how much each rank has to do, and of each body at such a pair which island it is of. From it all
// ranks find the same islands across borders (a forest of those alone), and who has too much. If any island moves, a
// second message brings it: who lives where, which all must know, and to its new rank the bodies' motions (halo.h), and
// what their pairs keep (holdings.h).
//
// The bits of a run do not depend on any of it.
//
// Thread-safety: the arranger's.
#ifndef OB_SIM_RANK_ISLANDS_H
#define OB_SIM_RANK_ISLANDS_H

#include "sim/halo.h"
#include "sim/holdings.h"
#include "sim/regions.h"

typedef struct ob_rank_islands ob_rank_islands;

ob_rank_islands *ob_rank_islands_create(const ob_universe *u); // NULL: no memory
void ob_rank_islands_destroy(ob_rank_islands *s); // NULL is allowed

// What moves, and where it is noted.
typedef struct ob_rank_parts {
	ob_halo *halo;
	ob_holdings *holdings;
	ob_regions *regions;
} ob_rank_parts;

// By all ranks, when each has found the islands of its bodies and before it lists their members. pair: of two ranks'
// bodies, so many that link them, the same on all ranks. islands: whether any rank has any. false: the step has failed.
bool ob_rank_islands_share(ob_rank_islands *s, ob_universe *u, ob_peers *p, const ob_rank_parts *parts,
			   const uint32_t *pair, uint32_t pairs, bool *islands);

#endif
