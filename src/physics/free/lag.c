#include "free/lag.h"

#include <math.h>

#include "shape/shape.h"

static const double least_bound = 1e-3; // s

// Least distance, m, between the bounding balls of the object and a neighbour, or a plane; *from: direction from there to the
// object.
static double gap_to(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other, ob_vec3 *from)
{
	const ob_vec3 way = ob_sub(s->motion.p, other->pose.p);
	const double radius = ob_shape_radius((ob_shape)s->passport.shape, s->passport.size), distance = ob_norm(way);
	if (ob_shape_is(n->passport.shape, OB_UNBOUNDED)) {
		const ob_mat3 r = ob_quat_matrix(other->pose.q);
		*from = ob_column(&r, 2);
		return ob_dot(*from, way) - radius;
	}
	*from = ob_scale(way, 1 / ob_max(distance, 1e-9));
	return distance - radius - ob_shape_radius((ob_shape)n->passport.shape, n->passport.size);
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

// First time, s, at which gap - closing t - pull t^2 / 2 is 0; infinity: never.
static double first_zero(double gap, double closing, double pull)
{
	const double square = closing * closing + 2 * pull * gap, sum = closing + sqrt(ob_max(0, square));
	return square >= 0 && sum > 0 ? 2 * gap / sum : INFINITY;
}

// Extent, m, of a body along a direction, and the speed at which turning may change it, m/s.
static double extent_of(const ob_passport *p, ob_quat q, ob_vec3 w, ob_vec3 along, double *turning)
{
	const ob_mat3 r = ob_quat_matrix(q);
	*turning += ob_shape_is(p->shape, OB_ISOTROPIC) ? 0 : ob_norm(w) * ob_shape_radius((ob_shape)p->shape, p->size);
	return ob_shape_extent((ob_shape)p->shape, p->size, ob_rotate_back(&r, along));
}

double ob_free_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other, ob_vec3 outer,
		     ob_vec3 theirs)
{
	ob_vec3 from;
	const bool plane = ob_shape_is(n->passport.shape, OB_UNBOUNDED);
	const ob_vec3 v = ob_sub(s->motion.v, other->v), a = ob_sub(outer, theirs);
	const double gap = gap_to(s, n, other, &from), closing = -ob_dot(from, v), pull = -ob_dot(from, a),
		     radius = ob_shape_radius((ob_shape)s->passport.shape, s->passport.size),
		     balls = plane ? radius : radius + ob_shape_radius((ob_shape)n->passport.shape, n->passport.size);
	// along the direction from one to the other, two convex bodies are as far apart as their extents leave
	double turning = 0, extents = extent_of(&s->passport, s->motion.q, s->motion.w, from, &turning);
	if (!plane)
		extents += extent_of(&n->passport, other->pose.q, other->w, from, &turning);
	const double left = gap + balls - extents;
	double time = left > 0 ? first_zero(left, closing + turning, pull) : 0;
	if (gap > 0)
		time = ob_max(time, first_zero(gap, closing, pull));
	if (gap > 0 && !plane && isfinite(time) &&
	    ob_norm2(a) == 0) { // both fly straight past each other: |d + v t| = balls
		const double d = gap + balls, square = d * d * closing * closing - ob_norm2(v) * gap * (d + balls);
		time = square < 0 ? INFINITY : ob_max(time, gap * (d + balls) / (d * closing + sqrt(square)));
	}
	return time > 0 ? s->time + time : 0;
}

double ob_free_lag_apart(const ob_free_sim *s, const ob_free_neighbour *n, const ob_state *other)
{
	ob_vec3 from;
	const double gap = gap_to(s, n, other, &from), closing = ob_norm(ob_sub(s->motion.v, other->v));
	return gap > 0 ? .5 * gap / (closing + 1e-9) : 0;
}
