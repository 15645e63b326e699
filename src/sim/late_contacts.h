// Late contacts: pairs that touched within the step although their islands were solved apart; and the forecast of the
// pairs that will touch in the coming step.
//
// Islands are made of pairs that touch and of pairs that are expected to (ob_pair_key.expected): a forecast that takes
// every object to go on as it does. It fails where an object is hit and hits another one within the same step. So after
// the islands are solved, each pair of an object that was solved and that was in none of them is checked: has the path
// that both have made used up the known distance between them, and do they touch at the step's end, or did they on the
// way? Then their islands are merged and solved again.
#ifndef OB_SIM_LATE_CONTACTS_H
#define OB_SIM_LATE_CONTACTS_H

#include "sim/state.h"

// By the scheduling worker, before pairs are checked: lists those whose turn it is (sim/calendar.h) in
// ob_step_data.check, ascending. The pairs of objects that have been solved are among them: who has listed those of their
// islands has entered them (island_builder.c). solved: a step has been solved and is not yet committed.
void ob_late_contacts_begin(ob_universe *u, bool solved);
// Checks first .. end-1 of them: sets expected, late and limit of each, enters in the calendar when it must be checked
// again, and notes in ob_step_data.count whether any contact is late.
void ob_late_contacts_check(ob_sim *s, uint32_t first, uint32_t end, bool solved);
// By the scheduling worker, when all of them are checked. Contained simulators cannot write the calendar: the arranger
// makes its entries here.
void ob_late_contacts_end(ob_universe *u);
// By the arranger of one of several ranks, before that: another has checked the pair, and its key says what was found.
void ob_late_contacts_take(ob_universe *u, uint32_t pair);

#endif
