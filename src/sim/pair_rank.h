// The rank that keeps a pair's state, and checks it, of several (peers.h). All ranks know that a pair exists, and if it
// touches.
//
// Thread-safety: any worker may query between two changes of homes (table/home.h); else the arranger alone.
#ifndef OB_SIM_PAIR_RANK_H
#define OB_SIM_PAIR_RANK_H

#include "table/table.h"

// True if this rank has one of the pair's objects.
bool ob_pair_is_known_here(const ob_universe *u, const ob_pair_key *k);
// True if this rank checks the pair: the one where a lives, or b if a does not move.
bool ob_pair_is_checked_here(const ob_universe *u, const ob_pair_key *k);
// True if the pair links two ranks' bodies.
bool ob_pair_is_across(const ob_universe *u, const ob_pair_key *k);
// Schedules the pairs of an object that another rank has solved in this step: those that are checked here are, at the
// step's end. Their known distance is void if islands have been merged.
void ob_pairs_follow(ob_universe *u, uint32_t id);

#endif
