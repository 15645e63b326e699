// Properties of two convex shapes by simple and slow methods, for tests of their closed forms.
#ifndef OB_TESTS_CONTACT_CONVEX_H
#define OB_TESTS_CONTACT_CONVEX_H

#include "placed.h"

// Extent of the shape from its centre along the unit direction n (m); infinity: without end.
static inline double reach(const ob_placed *x, ob_vec3 n)
{
	ob_vec3 l = ob_rotate_back(&x->r, n);
	switch (x->shape) {
	case OB_SHAPE_SPHERE:
		return x->size.x;
	case OB_SHAPE_CAPSULE:
		return x->size.x + fabs(l.z) * x->size.y;
	case OB_SHAPE_CYLINDER:
		return x->size.x * sqrt(l.x * l.x + l.y * l.y) + fabs(l.z) * x->size.y;
	case OB_SHAPE_HULL: {
		double most = -INFINITY;
		for (uint32_t k = 0; k < x->hull->corners; k++)
			most = fmax(most, ob_dot(l, x->hull->corner[k]));
		return most;
	}
	case OB_SHAPE_PLANE:
		return l.z > 1 - 1e-12 ? 0 : INFINITY;
	default:
		return half_width(x, n);
	}
}

// Separation of the shapes along the unit direction n, from b to a (m): never more than their distance.
static inline double apart_along(const ob_placed *a, const ob_placed *b, ob_vec3 n)
{
	return ob_dot(n, ob_sub(a->p, b->p)) - reach(a, ob_scale(n, -1)) - reach(b, n);
}

static inline double limited(double x, double limit)
{
	return fmax(-limit, fmin(limit, x));
}

// Nearest point of the shape to x.
static inline ob_vec3 nearest_in(const ob_placed *s, ob_vec3 x)
{
	ob_vec3 l = ob_rotate_back(&s->r, ob_sub(x, s->p)), core = { 0, 0, 0 };
	double radius = s->size.x;
	if (s->shape == OB_SHAPE_PLANE) {
		l.z = fmin(l.z, 0);
	} else if (s->shape == OB_SHAPE_BOX) {
		l = ob_v3(limited(l.x, s->size.x), limited(l.y, s->size.y), limited(l.z, s->size.z));
	} else if (s->shape == OB_SHAPE_CYLINDER) {
		double across = sqrt(l.x * l.x + l.y * l.y), k = across > radius ? radius / across : 1;
		l = ob_v3(k * l.x, k * l.y, limited(l.z, s->size.y));
	} else {
		if (s->shape == OB_SHAPE_CAPSULE)
			core.z = limited(l.z, s->size.y);
		ob_vec3 d = ob_sub(l, core);
		double from = ob_norm(d);
		l = from > radius ? ob_madd(core, radius / from, d) : l;
	}
	return ob_add(s->p, ob_rotate(&s->r, l));
}

// Distance by alternating projections (Cheney and Goldstein 1959): from above, never too small.
static inline double distance_from_above(const ob_placed *a, const ob_placed *b, int rounds)
{
	ob_vec3 x = a->p, y = b->p;
	for (int i = 0; i < rounds; i++) {
		ob_vec3 before = x;
		y = nearest_in(b, x);
		x = nearest_in(a, y);
		if (ob_norm2(ob_sub(x, before)) < 1e-30)
			break;
	}
	return ob_norm(ob_sub(x, y));
}

// Largest separation over all directions, negative if the shapes overlap: random directions, then a pattern search
// round the best (Hooke and Jeeves 1961). From below, never too large. Not for planes.
static inline double farthest_apart(uint64_t *seed, const ob_placed *a, const ob_placed *b, int directions)
{
	double best = -INFINITY;
	ob_vec3 at = { 0, 0, 1 };
	for (int k = 0; k < directions; k++) {
		ob_vec3 n = random_direction(seed);
		double gap = apart_along(a, b, n);
		if (gap > best)
			best = gap, at = n;
	}
	for (double step = .1; step > 1e-9;) {
		double before = best;
		for (int k = 0; k < 12; k++) {
			ob_vec3 n = ob_madd(at, step, random_direction(seed));
			n = ob_scale(n, 1 / ob_norm(n));
			double gap = apart_along(a, b, n);
			if (gap > best)
				best = gap, at = n;
		}
		step *= best > before ? 1.5 : .6;
	}
	return best;
}

#endif
