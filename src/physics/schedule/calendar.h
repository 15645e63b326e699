// Calendars of the steps in which objects and pairs are due, so that a step costs only the work due in it.
//
//   of_4096    urgency ────────────────┐             the largest urgency below it, or more
//   of_64      urgency, urgency, ..  urgency, ..
//   one        urgency, urgency, ..                  of each entry: larger if sooner; 0: no entry
//
// One calendar holds the step in which each object must be solved (ob_schedule.due), another that in which each pair
// must be checked (step/late_contacts.h). Each rank enters only its own. A search descends only where the level above is
// urgent enough. It reads some cache lines for each entry found, and one word in 4096 of the rest. An urgency that is
// too large, because an entry was put off, is corrected by the next search that descends there.
//
// Not used: a timing wheel, made of lists. Setting an entry would follow three pointers, which costs more than the
// check of most pairs. Here, due entries are found in ascending order, as they lie in memory.
//
// Calendars lie in the universe, among the areas that a checkpoint holds; after a restart from a file they are rebuilt
// (step/pairs.h). Only the scheduling worker uses them, or the host at a pause. Exception: any worker may set entries of
// objects that it has solved and of pairs that it has checked.
#ifndef OB_SCHEDULE_CALENDAR_H
#define OB_SCHEDULE_CALENDAR_H

#include "table/table.h"

typedef struct ob_calendar {
	ob_calendar_levels level;
	uint32_t end; // all entries have indices below
	uint64_t *visits; // as in ob_step_counts
} ob_calendar;

ob_calendar ob_calendar_of_objects(const ob_universe *u);
ob_calendar ob_calendar_of_pairs(const ob_universe *u);

// Sets the entry of i to this step (from 0); UINT32_MAX or more removes it. Several workers may set their own entries
// at the same time, while none lists any.
void ob_calendar_set(const ob_calendar *c, uint32_t i, uint64_t step);
// Sets the object's entry after a change of its schedule record or home rank: to the step in which it is due. With
// several ranks, only its home rank has the entry. Threads: as above.
void ob_calendar_enter_due(const ob_universe *u, uint32_t id);
// True if an entry is due in this step or was due before.
bool ob_calendar_is_due(const ob_calendar *c, uint64_t step);
// Lists all such entries, ascending, at most "most"; returns their number. The entries stay.
uint32_t ob_calendar_list(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most);
// Lists and removes them.
uint32_t ob_calendar_take(const ob_calendar *c, uint64_t step, uint32_t *list, uint32_t most);
// Returns the first step that has an entry; UINT32_MAX if none has.
uint32_t ob_calendar_first(const ob_calendar *c);
// Removes all entries.
void ob_calendar_clear(const ob_calendar *c);

// ---- work

// Work of a step: its limit, and fair shares of it. Work is counted, never timed; unit: step/budget.h.

// Work of some us: for less the gate costs more than another worker gains.
enum { OB_WORK_WORTH_A_WORKER = 48 };

// Returns the work that a step may take. Any thread.
uint64_t ob_work_limit(const ob_universe *u);
// Adds work done on this object to the step's. Returns true if that exceeds the limit; then the step has failed. Any
// worker.
bool ob_work_add(ob_universe *u, uint64_t work, uint32_t object);
// Returns the work of a full share when "count" simulators, or ranks, divide the total: others get the excess. Pure.
uint64_t ob_work_share(uint64_t total, uint32_t count);

#endif
