// Which rank knows of a pair what is known of it, and checks it, of several (peers.h). That the pair is there, and
// whether it touches, all know.
//
// Thread-safety: to ask, any worker's between two deals of homes (table/home.h); else the arranger's.
#ifndef OB_SIM_PAIR_RANK_H
#define OB_SIM_PAIR_RANK_H

#include "table/table.h"

// Whether this rank has one of its objects.
bool ob_pair_is_known_here(const ob_universe *u, const ob_pair_key *k);
// Whether it checks the pair: where a lives, or b if a does not move.
bool ob_pair_is_checked_here(const ob_universe *u, const ob_pair_key *k);
// Whether the pair is of two ranks' bodies.
bool ob_pair_is_across(const ob_universe *u, const ob_pair_key *k);
// The object was solved in this step, by another rank. Those of its pairs that are checked here are, when it is over;
// what is known of their distance is void if islands have been merged.
void ob_pairs_follow(ob_universe *u, uint32_t id);

#endif
