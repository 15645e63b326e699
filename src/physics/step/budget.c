#include "step/budget.h"

#include "schedule/calendar.h"
#include "table/outbox.h"

void ob_budget_begin_share(ob_sim *s, uint32_t object)
{
	s->budget.object = object;
	s->solver.budget.told = ob_budget_work(&s->solver);
	s->budget.share = 0;
	if (s->settings->freezes)
		s->solver.budget.spent = false;
	ob_worker_set_object(s->u, s->worker, object);
}

// Adds work to the share's own budget. Returns true if it is exceeded or the run was stopped. A budget of its own makes
// the result independent of other workers: the same shares fail in every run.
static bool spends_share(ob_sim *s, uint64_t work)
{
	s->budget.share += work;
	ob_step_work_add(s->u, work);
	const bool stopped = ob_gate_stopped(s->u);
	if (stopped || s->budget.share > ob_work_limit(s->u))
		ob_step_fail(s->u, stopped ? OB_STEP_LEFT : OB_STEP_OVERWORKED, s->budget.object);
	return stopped || s->budget.share > ob_work_limit(s->u);
}

bool ob_budget_spend(void *sim, uint64_t work)
{
	ob_sim *s = sim;
	if (s->settings->freezes)
		return spends_share(s, work);
	if (ob_universe_contained(s->u))
		ob_outbox_end_of(s->u)->worked_on = s->budget.object;
	if (ob_gate_stopped(s->u))
		ob_step_fail(s->u, OB_STEP_LEFT, s->budget.object);
	ob_work_add(s->u, work, s->budget.object);
	return ob_step_failed(s->u, NULL) != OB_STEP_OK;
}
