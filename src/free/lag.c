#include "free/lag.h"

#include <math.h>

static const double least_bound = 1e-3; // s

bool ob_free_lag_allows(ob_free_sim *s, const ob_free_scratch *x)
{
	const double most = x->free->max_lag;
	if (isinf(most))
		return true;
	for (uint32_t i = 0; i < s->neighbours; i++) {
		const ob_free_neighbour *n = &s->neighbour[i];
		const double bound = ob_min(most, ob_max(least_bound, n->bound));
		if (n->kind != OB_FREE_SIMULATED || ob_free_time(x->u, n->id) + bound >= s->time ||
		    ob_free_kind_of(x->u, n->id, NULL) != OB_FREE_SIMULATED)
			continue;
		s->blocker = n->id;
		s->needed = s->time - bound;
		return false;
	}
	return true;
}

bool ob_free_lag_is_over(const ob_free_sim *s, const ob_universe *u)
{
	return ob_free_time(u, s->blocker) >= s->needed || ob_free_kind_of(u, s->blocker, NULL) != OB_FREE_SIMULATED;
}

double ob_free_lag_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other)
{
	const double gap = ob_norm(ob_sub(s->motion.p, other->pose.p)) -
			   ob_shape_radius((ob_shape)s->passport.shape, s->passport.size) -
			   ob_shape_radius((ob_shape)n->passport.shape, n->passport.size),
		     closing = ob_norm(ob_sub(s->motion.v, other->v));
	return gap > 0 ? .5 * gap / (closing + 1e-9) : 0;
}
