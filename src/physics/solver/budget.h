// Account of the solver's work. The solver notes it, and from time to time reports it to the caller
// (ob_island_calls.spend), which ends work beyond a limit. Counted, never timed, so every run ends at the same point.
#ifndef OB_SOLVER_BUDGET_H
#define OB_SOLVER_BUDGET_H

#include "solver/solver.h"

// Notes work that the counters do not contain.
static inline void ob_budget_note(ob_solver *s, uint64_t work)
{
	s->budget.noted += work;
}

// Work so far.
static inline uint64_t ob_budget_work(const ob_solver *s)
{
	return s->budget.noted + s->counters.pair_solves;
}

// Returns true if the caller allows no more. Then unfinished work may be left as it is: nothing of it is used.
bool ob_budget_spent(ob_solver *s);

#endif
