// Pairs of objects whose fat AABBs overlap, each with a record while they touch, and for each object the list of its
// pairs.
//
//   first_pair[5] ──> pair 12 (5, 9) ──> pair 3 (2, 5) ──> ..
//   first_pair[9] ──────┘
//
// A pair stays where it is in pair[] as long as it exists, so lists and checks name it by its index. What is static
// keeps no list: the ground has a pair with each object, and nobody ever asks for all of them.
//
// Written by the scheduling worker alone, and by the host at a pause.
#ifndef OB_SIM_PAIRS_H
#define OB_SIM_PAIRS_H

#include "table/table.h"

// Whether the object has a list of its pairs.
static inline bool ob_has_pairs(const ob_step_data *data, uint32_t id)
{
	return data->schedule[id].state >= OB_SCHEDULE_KINEMATIC;
}

// The pair's state before the step; NULL if it did not touch. Any worker, while islands are solved.
const ob_pair_state *ob_pair_state_before(const ob_universe *u, const ob_pair_key *k);
// Did its contact carry a load then?
bool ob_pair_carried_load(const ob_universe *u, const ob_pair_key *k);

// Finds the object's neighbours, and what that changes of its pairs, which is handed over. box_tests grows by the boxes
// that were compared. Any worker, after the scheduling worker has updated the index.
void ob_pairs_query(ob_universe *u, uint32_t id, uint64_t *box_tests);
// Makes the changes that queries of the objects on the requery list have brought, and empties the list. steps: that are
// complete, or solved. Lists the new pairs in ob_step_data.check. How far apart they are, whoever checks them finds out
// (limit: NAN) ..
void ob_pairs_merge(ob_universe *u, uint64_t steps);
// .. or the scheduling worker, here: of several ranks not all know the motions of both, and then not until those that
// need them do (halo.h).
void ob_pairs_measure(ob_universe *u, uint64_t steps);
// The path of both together beyond which they may touch (m).
double ob_pair_first_limit(const ob_universe *u, const ob_pair_key *k, uint64_t steps);
// Drops every pair of an object that goes away.
void ob_pairs_drop(ob_universe *u, uint32_t id);
// All pairs of the object are checked before its next step, for it moves otherwise from now on.
void ob_pairs_look(ob_universe *u, uint32_t id);
// Makes anew what follows from schedule[] and pair[], which somebody has filled: all lists, both calendars
// (sim/calendar.h), and the list of the pairs of the last step's islands, of which those that touch no more have their
// records taken away.
void ob_pairs_link(ob_universe *u);
// Gives the pair's record back, if it has one. Between steps: what a step has written may be read until its end.
void ob_pair_release_record(ob_universe *u, ob_pair_key *k);

#endif
