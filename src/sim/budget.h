// The budget of a step: how much work it may take before the run ends, with the names of those that it went into. So no
// scene hangs, however thin, fast or stiff what is in it. Work is counted, never timed: the run ends in the same step
// on any machine, with any number of workers. Its unit is what a pair costs in an iteration of the contact solver, some
// 30 ns; what is done much of, and costs more, is noted as so many units.
//
// The budget is looked at wherever a scene can choose how often something is done: in each collision test, after which
// nothing touches any more (narrowphase.c), each iteration, each impact, each plane that a flight may end on. So a step
// ends soon once it is spent, or the run is stopped.
//
// A share is what is worked on as a whole, and by one worker: an island, or a batch of pairs. Shares are counted in
// grains, and what is left over at a share's end is dropped, so that the sum does not depend on who worked on which.
//
// Where what fails is frozen (ob_run_settings.freezes), each share has all of the budget for itself, and all shares of
// the phase are worked on even if one has failed: which objects fail is then the same in every run, too.
#ifndef OB_SIM_BUDGET_H
#define OB_SIM_BUDGET_H

#include "sim/state.h"

// object: whom to blame for what this share costs, and for the worker's death, should it die of it.
void ob_budget_begin_share(ob_sim *s, uint32_t object);
// true: the budget is spent, or the run was stopped; the step has failed, and what is under way may be left as it is.
bool ob_budget_spent(ob_sim *s);

// The same of work that another has done on this object.
bool ob_budget_add(ob_universe *u, uint64_t work, uint32_t object);

// Work that the counters do not show.
static inline void ob_budget_note(ob_sim *s, uint64_t work)
{
	s->budget.noted += work;
}

#endif
