#include "schedule/work.h"

// Work for small but hard scenes, and for each object of a large one.
static const uint64_t base = UINT64_C(1) << 27, per_object = 1 << 15;

uint64_t ob_work_limit(const ob_universe *u)
{
	const uint32_t given = ob_universe_settings(u)->budget;
	return given ? per_object * given : base + per_object * ob_universe_ids(u);
}

bool ob_work_add(ob_universe *u, uint64_t work, uint32_t object)
{
	if (ob_step_work_add(u, work) <= ob_work_limit(u))
		return false;
	ob_step_fail(u, OB_STEP_OVERWORKED, object);
	return true;
}

uint64_t ob_work_share(uint64_t total, uint32_t count)
{
	enum { SLACK = 10, WORTH_SHARING = 16 * OB_WORK_WORTH_A_WORKER };
	const uint64_t share = total / count + total / (count * SLACK) + 1;
	return share > WORTH_SHARING ? share : WORTH_SHARING;
}
