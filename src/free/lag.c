#include "free/lag.h"

#include <math.h>

#include "shape/shape.h"

static const double least_bound = 1e-3; // s

// Least distance, m, between the bounding balls of the object and a neighbour, or a plane.
static double gap_to(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other)
{
	const ob_vec3 way = ob_sub(s->motion.p, other->pose.p);
	const ob_mat3 r = ob_quat_matrix(other->pose.q);
	const double radius = ob_shape_radius((ob_shape)s->passport.shape, s->passport.size);
	return ob_shape_is(n->passport.shape, OB_UNBOUNDED)
		       ? ob_dot(ob_column(&r, 2), way) - radius
		       : ob_norm(way) - radius - ob_shape_radius((ob_shape)n->passport.shape, n->passport.size);
}

bool ob_free_lag_allows(ob_free_sim *s, const ob_free_scratch *x)
{
	const double most = x->free->max_lag,
		     least = ob_min(least_bound, ob_max(s->step, 1 / (OB_FREE_SHORTEST * s->rate)));
	if (isinf(most))
		return true;
	for (uint32_t i = 0; i < s->neighbours; i++) {
		const ob_free_neighbour *n = &s->neighbour[i];
		const double bound = ob_min(most, ob_max(least, n->bound));
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

double ob_free_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other, double rate)
{
	const double speed = ob_norm(ob_sub(s->motion.v, other->v)), gap = gap_to(s, n, other);
	return gap > 0 ? s->time + 2 * gap / (speed + sqrt(speed * speed + 2 * rate * gap) + 1e-9) : 0;
}

double ob_free_lag_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other)
{
	const double gap = gap_to(s, n, other), closing = ob_norm(ob_sub(s->motion.v, other->v));
	return gap > 0 ? .5 * gap / (closing + 1e-9) : 0;
}
