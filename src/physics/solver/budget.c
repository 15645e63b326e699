#include "solver/budget.h"

enum { GRAIN = 1 << 12 };

bool ob_budget_spent(ob_solver *s)
{
	const uint64_t work = (ob_budget_work(s) - s->budget.told) / GRAIN * GRAIN;
	if (work == 0 || s->budget.spent)
		return s->budget.spent;
	s->budget.told += work;
	return s->budget.spent = s->calls.spend(s->calls.with, work);
}
