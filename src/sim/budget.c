#include "sim/budget.h"

#include "table/outbox.h"

// Work for small but hard scenes, and for each object of a large one.
static const uint64_t base = UINT64_C(1) << 27, per_object = 1 << 15;

void ob_budget_begin_share(ob_sim *s, uint32_t object)
{
	s->budget.object = object;
	s->solver.budget.told = ob_budget_work(&s->solver);
	s->budget.share = 0;
	if (s->settings->freezes)
		s->solver.budget.spent = false;
	ob_worker_set_object(s->u, s->worker, object);
}

static uint64_t most_work(const ob_universe *u)
{
	return base + per_object * ob_universe_ids(u);
}

bool ob_budget_add(ob_universe *u, uint64_t work, uint32_t object)
{
	if (ob_step_work_add(u, work) <= most_work(u))
		return false;
	ob_step_fail(u, OB_STEP_OVERWORKED, object);
	return true;
}

// Adds work to the share's own budget. Returns true if it is exceeded or the run was stopped. A budget of its own makes
// the result independent of other workers: the same shares fail in every run.
static bool spends_share(ob_sim *s, uint64_t work)
{
	s->budget.share += work;
	const bool stopped = ob_gate_stopped(s->u);
	if (stopped || s->budget.share > most_work(s->u))
		ob_step_fail(s->u, stopped ? OB_STEP_LEFT : OB_STEP_OVERWORKED, s->budget.object);
	return stopped || s->budget.share > most_work(s->u);
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
	ob_budget_add(s->u, work, s->budget.object);
	return ob_step_failed(s->u, NULL) != OB_STEP_OK;
}
