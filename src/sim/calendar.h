// Calendars: when somebody must look at an object, or at a pair, so that a step costs what happens in it.
//
//   of_4096    urgency ────────────────┐             the most urgent of those below, or more
//   of_64      urgency, urgency, ..  urgency, ..
//   one        urgency, urgency, ..                  of each: the sooner, the more; 0: it has no entry
//
// One says when each object must be solved (ob_schedule.due), one when each pair must be checked (sim/late_contacts.h);
// of several ranks each of those that are its own. Who looks for what is due goes down where that is said, so he reads
// some cache lines for each that he finds, and one word in 4096 of the rest. A level that says too much, because an
// entry was put off, is put right by whoever goes down there.
//
// Turned down: a timing wheel, of lists. It follows three pointers for each entry that is set, which costs more than
// the check of most pairs; here what is due comes in ascending order, as it lies in memory.
//
// They lie in the universe, among the areas that a checkpoint holds; after a restart from a file they are made anew
// (sim/pairs.h). By the scheduling worker alone, or the host at a pause; but workers enter when objects that they have
// solved are due again, and when pairs that they have checked are to be checked again, each for its own.
#ifndef OB_SIM_CALENDAR_H
#define OB_SIM_CALENDAR_H

#include "table/table.h"

typedef struct ob_calendar {
	ob_calendar_levels level;
	uint32_t end; // no entry has an index from here on
	uint64_t *visits; // as ob_step_counts
} ob_calendar;

ob_calendar ob_calendar_of_objects(const ob_universe *u);
ob_calendar ob_calendar_of_pairs(const ob_universe *u);

// The entry of i is for this step (from 0) from now on; UINT32_MAX or more: it has none. Several workers may set entries
// of their own at the same time, while nobody lists any.
void ob_calendar_set(const ob_calendar *c, uint32_t i, uint64_t step);
// The object's schedule record has changed, or its home: its entry is for the step in which that says it is due, of
// several ranks where it lives. As above.
void ob_calendar_enter_due(const ob_universe *u, uint32_t id);
// Is there an entry for this step, or for one before?
bool ob_calendar_is_due(const ob_calendar *c, uint64_t step);
// All that have such an entry, ascending, at most so many; returns how many. Their entries stay.
uint32_t ob_calendar_list(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most);
// The same, but they have none any more.
uint32_t ob_calendar_take(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most);
// The first step for which there is an entry; UINT32_MAX: there is none.
uint32_t ob_calendar_first(const ob_calendar *c);
// There is no entry any more.
void ob_calendar_clear(const ob_calendar *c);

#endif
