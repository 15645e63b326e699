#include "sim/calm.h"

static const double slow = 1e-3; // m/s, of any point of a member
static const double stirring = 1e-7; // m/s: a round that changes a velocity by more has found something
static const double lasting = .1; // s, for which what is still has been slow

bool ob_equilibrium_likely(const ob_sim *s, const ob_island *is)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const uint32_t *id = ob_universe_step_data(s->u)->member + is->first_member;
	if (run->substeps == 1 || s->island.substeps > run->substeps || run->solver != OB_SOLVER_COLOURED ||
	    run->integrator != OB_INTEGRATOR_EXACT)
		return false;
	for (uint32_t i = 0; i < is->members; i++)
		if (!(ob_newest_motion(s->u, id[i])->flags & OB_MOTION_STEADY))
			return false;
	return true;
}

bool ob_equilibrium_confirmed(const ob_island_work *w)
{
	return w->stirred <= stirring && !w->pushed;
}

bool ob_equilibrium_reached(const ob_island_work *w)
{
	if (!ob_equilibrium_confirmed(w))
		return false;
	for (uint32_t i = 1; i <= w->members; i++) {
		const ob_body *m = &w->member[i];
		if (m->contacts == 0 || m->speed > stirring || m->rest_time < lasting)
			return false;
	}
	return true;
}

bool ob_equilibrium_body_steady(const ob_island_work *w, uint32_t row)
{
	return w->member[row].contacts > 0 && w->member[row].speed <= slow;
}
