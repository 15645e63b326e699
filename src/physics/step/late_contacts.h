// Late contacts: pairs that touched within the step although their islands were solved apart; and the forecast of the
// pairs that will touch in the coming step.
//
// Islands are made of pairs that touch and of pairs that are expected to (ob_pair_key.expected). The forecast assumes
// that every object goes on as it does. It fails where an object is hit and hits another one within the same step. So
// after the islands are solved, each pair of a solved object that was in no island is checked. A late contact is one
// whose bodies' paths have used up the known distance, and that touches at the step's end or did on the way. Then their
// islands are merged and solved again.
#ifndef OB_STEP_LATE_CONTACTS_H
#define OB_STEP_LATE_CONTACTS_H

#include "step/state.h"

// Lists the due pairs (schedule/calendar.h) in ob_step_data.check, ascending. The scheduling worker calls it before pairs
// are checked. Pairs of solved objects are among them: the worker that listed their islands' pairs has entered them
// (island_builder.c). solved: a step has been solved and is not yet committed.
void ob_late_contacts_begin(ob_universe *u, bool solved);
// Drops listed pairs that this rank entered when it had one of their objects, which lives elsewhere now.
void ob_late_contacts_leave_to_others(ob_universe *u);
// Checks pairs first .. end-1: sets expected, late and limit of each, enters its next check in the calendar, and notes
// in ob_step_data.count if any contact is late.
void ob_late_contacts_check(ob_sim *s, uint32_t first, uint32_t end, bool solved);
// Ends the checks; the scheduling worker calls it when all pairs are checked. Contained simulators cannot write the
// calendar: the arranger makes their entries here.
void ob_late_contacts_end(ob_universe *u);
// Takes the result of another rank's check from the pair's key; the arranger of one of several ranks calls it before.
void ob_late_contacts_take(ob_universe *u, uint32_t pair);

#endif
