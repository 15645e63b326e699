// Pairs of objects whose fat AABBs overlap, each with a record while they touch, and for each object the list of its
// pairs.
//
//   first_pair[5] ──> pair 12 (5, 9) ──> pair 3 (2, 5) ──> ..
//   first_pair[9] ──────┘
//
// A pair keeps its index in pair[] as long as it exists, so lists and checks refer to it by that. Static objects keep
// no list: the ground has a pair with each object, and no caller needs all of them.
//
// Thread-safety: the scheduling worker alone writes pairs, and the host at a pause.
#ifndef OB_STEP_PAIRS_H
#define OB_STEP_PAIRS_H

#include "table/table.h"

// True if the object has a list of its pairs.
static inline bool ob_has_pairs(const ob_step_data *data, uint32_t id)
{
	return data->schedule[id].state >= OB_SCHEDULE_KINEMATIC;
}

// Returns the pair's state before the step; NULL if it did not touch. Any worker, while islands are solved.
const ob_pair_state *ob_pair_state_before(const ob_universe *u, const ob_pair_key *k);

// Finds the object's neighbours, and hands over the changes of its pairs. box_tests grows by the number of boxes
// compared. Any worker, after the scheduling worker has updated the index.
void ob_pairs_query(ob_universe *u, uint32_t id, uint64_t *box_tests);
// Makes the changes of pairs that queries of the objects on the requery list have found, and empties the list. steps:
// number complete, or solved. Lists the new pairs in ob_step_data.check. Their limit is NAN until the worker that
// checks them measures it.
void ob_pairs_merge(ob_universe *u, uint64_t steps);
// Measures the limit of new pairs, by the scheduling worker. Not all of several ranks know the motions of both bodies
// before the ranks that need them have exchanged them (halo.h).
void ob_pairs_measure(ob_universe *u, uint64_t steps);
// Path of both bodies together beyond which they may touch (m).
double ob_pair_first_limit(const ob_universe *u, const ob_pair_key *k, uint64_t steps);
// Drops all pairs of an object that is removed.
void ob_pairs_drop(ob_universe *u, uint32_t id);
// Same for one that moves, by its list: as far as it is the only one of two that moves, its static partners keep none.
void ob_pairs_drop_listed(ob_universe *u, uint32_t id);
// Host, paused: takes in a pair from another universe; both objects are here. before: newest state of its contact, with
// its stamp (ob_pair_record); NULL: none. check: step of its next check, as ob_pairs_next_check there.
void ob_pairs_take_in(ob_universe *u, const ob_pair_key *key, const ob_pair_state *before, const double *impulse_b,
		      uint32_t stamp, uint32_t check);
uint32_t ob_pairs_next_check(const ob_step_data *data, uint32_t pair); // UINT32_MAX: none
// Host, paused after `steps`: begins pairs of two objects, and lists them in ob_step_data.check, from 0 on.
void ob_pairs_begin(ob_universe *u, uint32_t a, uint32_t b, uint64_t steps);
// True if the object has a pair with another.
bool ob_pairs_have(const ob_step_data *data, uint32_t id, uint32_t other);
// Rebuilds the data that follow from schedule[] and pair[], which the caller has filled: all lists, both calendars
// (schedule/calendar.h), and the list of pairs in the last step's islands. Takes the records of those that touch no more.
void ob_pairs_link(ob_universe *u);

#endif
