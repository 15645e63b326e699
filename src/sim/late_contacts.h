// Which pairs meet that were in different islands, and which will in the coming step.
//
// Islands are made of what touches and of what is expected to touch (ob_pair_key.expected): a forecast that takes every
// object to go on as it does. It fails where something is hit and hits something else within the same step. So after
// the islands are solved each pair that none of them looked after is checked: has the way that both have made used up
// what was known of their distance, and are they at the step's end, or were they on the way, in touch? Then they have
// met, and their islands are solved again as one.
#ifndef OB_SIM_LATE_CONTACTS_H
#define OB_SIM_LATE_CONTACTS_H

#include "sim/state.h"

enum { OB_LATE_CONTACTS_BATCH = 256 }; // pairs that a worker claims at a time

// By the arranger, before all pairs are checked. solved: a step has been solved and is not yet committed.
void ob_late_contacts_begin(ob_universe *u, bool solved);
// Pairs first .. end-1: sets near, met and limit, and notes whether any has met and when pairs must be checked next
// (ob_step_data.count).
void ob_late_contacts_check(ob_sim *s, uint32_t first, uint32_t end, bool solved);

#endif
