#include "sim/calm.h"

#include "sim/perceive.h"

static const double slow = 1e-3; // m/s, of any point of a member
static const double stirring = 1e-7; // m/s: a round that changes a velocity by more has found something

bool ob_calm_likely(const ob_sim *s, const ob_island *is)
{
	const ob_run_settings *run = ob_universe_settings(s->u);
	const uint32_t *id = ob_universe_exchange(s->u)->member + is->first_member;
	if (run->substeps == 1 || s->island.substeps > run->substeps || run->exchange != OB_EXCHANGE_COLOURED ||
	    run->integrator != OB_INTEGRATOR_EXACT)
		return false;
	for (uint32_t i = 0; i < is->members; i++) {
		const ob_motion *m = ob_newest_motion(s->u, id[i]);
		const ob_passport *pass = ob_passport_of(s->u, id[i]);
		double radius = ob_shape_radius(pass->shape, pass->size);
		if (!(m->quiet > 0) || ob_norm2(m->v) + radius * radius * ob_norm2(m->w) > slow * slow)
			return false;
	}
	return true;
}

bool ob_calm_proven(const ob_sim *s)
{
	return s->island.stirred <= stirring && !s->island.pushed;
}
