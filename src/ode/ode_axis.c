#include "ode/ode_axis.h"

enum { AXES_MAX = 6, TURNS = 8, ROUNDS = 100, PROJECTIONS = 20 };

struct search {
	const ob_ode_solid *a, *b;
	ob_vec3 best; // unit, from b to a
	double gap; // m, along it; the widest so far
};

static ob_vec3 unit(ob_vec3 n)
{
	return ob_scale(n, 1 / ob_norm(n));
}

static bool offer(struct search *s, ob_vec3 n)
{
	if (ob_norm2(n) < 1e-12)
		return false;
	n = unit(n);
	if (ob_dot(n, ob_sub(s->a->p, s->b->p)) < 0)
		n = ob_scale(n, -1);
	double gap = -ob_ode_solid_height(s->b, n, s->b->p) - ob_ode_solid_height(s->a, n, s->a->p) +
		     ob_dot(n, ob_sub(s->a->p, s->b->p));
	if (!(gap > s->gap))
		return false;
	s->gap = gap;
	s->best = n;
	return true;
}

static int axes_of(const ob_ode_solid *s, ob_vec3 axis[3])
{
	if (s->shape != OB_SHAPE_BOX) {
		axis[0] = ob_column(&s->r, 2);
		return 1;
	}
	for (int i = 0; i < 3; i++)
		axis[i] = ob_column(&s->r, i);
	return 3;
}

// The faces, the edges across each other, and what points from one to the other across an axis: where the gap has
// kinks.
static void offer_kinks(struct search *s)
{
	ob_vec3 axis[AXES_MAX], d = ob_sub(s->a->p, s->b->p);
	int n = axes_of(s->a, axis);
	n += axes_of(s->b, axis + n);
	offer(s, d);
	for (int i = 0; i < n; i++) {
		offer(s, axis[i]);
		offer(s, ob_madd(d, -ob_dot(d, axis[i]), axis[i]));
		for (int j = 0; j < i; j++)
			offer(s, ob_cross(axis[i], axis[j]));
	}
}

// TURNS steps round the best direction, turned a little each time so that no way up is missed for good, and along the
// kinks through it: across each axis.
static void climb(struct search *s)
{
	double phase = 0, step = .3;
	ob_vec3 axis[AXES_MAX];
	int n = axes_of(s->a, axis);
	n += axes_of(s->b, axis + n);
	// A gain in the last bits would keep the step long for ever: what counts is one of the step's own order.
	for (int round = 0; round < ROUNDS && step > 1e-5; round++) {
		double before = s->gap;
		ob_vec3 from = s->best;
		ob_vec3 u = unit(ob_cross(from, fabs(from.x) < .6 ? ob_v3(1, 0, 0) : ob_v3(0, 1, 0)));
		ob_vec3 v = ob_cross(from, u);
		for (int i = 0; i < TURNS; i++) {
			double angle = phase + i * (2 * M_PI / TURNS);
			offer(s, ob_madd(from, step, ob_madd(ob_scale(u, cos(angle)), sin(angle), v)));
		}
		for (int i = 0; i < n; i++) {
			ob_vec3 along = ob_cross(axis[i], from);
			offer(s, ob_madd(from, step, along));
			offer(s, ob_madd(from, -step, along));
		}
		phase += 2.399963229728653; // the golden angle
		step *= s->gap > before + 1e-3 * step * step ? 1 : .5;
	}
}

// Alternating projections (von Neumann 1950) end in the overlap, or at the points nearest to each other.
static ob_vec3 middle(const ob_ode_solid *a, const ob_ode_solid *b)
{
	ob_vec3 on_a = a->p, on_b = b->p;
	for (int i = 0; i < PROJECTIONS; i++) {
		on_b = ob_ode_solid_nearest(b, on_a);
		on_a = ob_ode_solid_nearest(a, on_b);
	}
	return ob_scale(ob_add(on_a, on_b), .5);
}

ob_ode_point ob_ode_axis_contact(const ob_ode_solid *a, const ob_ode_solid *b, ob_vec3 hint)
{
	struct search s = { .a = a, .b = b, .best = { 0, 0, 1 }, .gap = -INFINITY };
	offer(&s, hint);
	offer_kinks(&s);
	climb(&s);
	return (ob_ode_point){ middle(a, b), s.best, s.gap };
}
