// Work budget of a step: the run ends when a step exceeds it, and names the objects on which the work was spent. So no
// scene hangs, however thin, fast or stiff its objects. Work is counted, never timed: a run ends in the same step on
// any machine, with any number of workers. Unit: the cost of a pair in an iteration of the contact solver, some 30 ns.
// Frequent operations that cost more are noted as several units.
//
// The budget is checked wherever a scene determines the number of repetitions. These are collision tests (narrowphase.c
// reports no more contacts afterwards), iterations, impacts, and planes that end a flight. So a step ends soon after
// its budget is spent or the run is stopped.
//
// A share is the work that one worker does as a whole: an island, or a batch of pairs. Shares are counted in grains.
// The rest at a share's end is dropped, so that the sum does not depend on the distribution among workers.
//
// If failing objects are frozen (ob_run_settings.freezes), each share has the whole budget for itself. All shares of
// the phase are finished even if one has failed. So the same objects fail in every run. If all shares together have taken more
// when a phase ends, those that took most fail (crowd.h).
#ifndef OB_STEP_BUDGET_H
#define OB_STEP_BUDGET_H

#include "solver/budget.h"
#include "step/state.h"
#include "table/table.h"

// Begins a share. object: named as the cause if the budget is exceeded or the worker dies in this share.
void ob_budget_begin_share(ob_sim *s, uint32_t object);

// The solver's account (ob_island_calls.spend) of this worker: adds work to the share's object. Returns true if the budget
// is spent or the run was stopped; then the step has failed.
bool ob_budget_spend(void *sim, uint64_t work);

// ---- crowd

// Objects to blame where there is no room for pairs of neighbours, or where all shares of a step together are too much.

// Host, paused, after such a failure: lists the objects that are frozen for it: the one with most pairs first, and those that
// have at least half as many. Writes at most "most" ids; returns their number.
uint32_t ob_crowd(const ob_universe *u, uint32_t *ids, uint32_t most);

// The scheduling worker, when a phase of a run that freezes has ended: fails the step if its shares together took more than it
// may, and gives up those to be frozen. solved: islands were; then it is those that cost at least half as much as the dearest,
// else objects with at least half as many pairs as the most crowded one.
void ob_crowd_limit_work(ob_universe *u, bool solved);

#endif
