// Checks of pairs: when a pair is checked, and by which of several ranks (cluster/peers.h). All ranks know that a pair
// exists, and if it touches; one keeps its state.
//
// Thread-safety: any worker may query between two changes of homes (table/home.h); else the arranger alone.
#ifndef OB_SCHEDULE_PAIR_CHECKS_H
#define OB_SCHEDULE_PAIR_CHECKS_H

#include <math.h>

#include "table/table.h"

// True if this rank has one of the pair's objects.
bool ob_pair_is_known_here(const ob_universe *u, const ob_pair_key *k);
// True if this rank checks the pair: the one where a lives, or b if a does not move.
bool ob_pair_is_checked_here(const ob_universe *u, const ob_pair_key *k);
// True if the pair links two ranks' bodies.
bool ob_pair_is_across(const ob_universe *u, const ob_pair_key *k);
// The same of a joint that holds.
bool ob_joint_is_across(const ob_universe *u, const ob_joint_passport *j);
// Enters the pair for a check in this step. On several ranks one rank enters it, and all know that.
void ob_pair_enter_check(ob_universe *u, uint32_t pair, uint64_t step);
// Schedules a check of all pairs of the object before its next step, as its motion changes.
void ob_pairs_look(ob_universe *u, uint32_t id);
// Forgets what a check within the step has found: an island of the pair is solved again. Where the pair is checked and where the
// island is solved, which may be two ranks.
static inline void ob_pair_void_check(ob_pair_key *k)
{
	k->limit = -INFINITY;
	k->clear_until = 0;
}
// Schedules the pairs of an object that another rank has solved in this step: those that are checked here are, at the
// step's end. Their known distance is void if islands have been merged.
void ob_pairs_follow(ob_universe *u, uint32_t id);

#endif
