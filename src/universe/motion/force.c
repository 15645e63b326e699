#include "motion/force.h"

#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"

ob_force *ob_force_copy(const ob_force *f)
{
	ob_force *copy = malloc(sizeof *copy + f->points * sizeof *copy->point);
	if (!copy)
		return NULL;
	*copy = *f;
	copy->point = f->points ? (ob_path_point *)(copy + 1) : NULL;
	if (f->points)
		memcpy(copy->point, f->point, f->points * sizeof *copy->point);
	return copy;
}

// Impulse (N s) of the line between two points, from a to b.
static ob_vec3 line_impulse(const ob_path_point *p, const ob_path_point *q, double a, double b)
{
	const double middle = (.5 * (a + b) - p->t) / (q->t - p->t);
	return ob_scale(ob_madd(p->p, middle, ob_sub(q->p, p->p)), b - a);
}

static ob_vec3 linear_impulse(const ob_force *f, double a, double b)
{
	const ob_path_point *first = f->point, *last = f->point + f->points - 1;
	ob_vec3 sum = ob_scale(first->p, ob_max(0, ob_min(b, first->t) - a));
	for (const ob_path_point *p = first; p < last; p++) {
		const double from = ob_max(a, p->t), until = ob_min(b, p[1].t);
		if (from < until)
			sum = ob_add(sum, line_impulse(p, p + 1, from, until));
	}
	return ob_madd(sum, ob_max(0, b - ob_max(a, last->t)), last->p);
}

ob_vec3 ob_force_mean(const ob_force *f, double h, uint64_t step)
{
	const double a = (double)step * h, b = (double)(step + 1) * h, middle = f->frequency * .5 * (a + b) + f->phase,
		     half = .5 * f->frequency * h;
	switch (f->kind) {
	case OB_FORCE_SINE:
		return ob_scale(f->force, ob_sin(middle) * ob_sin(half) / half);
	case OB_FORCE_PULSE:
		return ob_scale(f->force, ob_max(0, ob_min(b, f->until) - ob_max(a, f->from)) / (b - a));
	case OB_FORCE_LINEAR:
		return ob_scale(linear_impulse(f, a, b), 1 / (b - a));
	}
	return ob_v3(0, 0, 0);
}

uint64_t ob_force_next(const ob_force *f, double h, uint64_t step)
{
	const double begins = f->kind == OB_FORCE_PULSE    ? f->from
			      : f->kind == OB_FORCE_LINEAR ? f->point[0].t
							   : 0,
		     ends = f->kind == OB_FORCE_PULSE    ? f->until
			    : f->kind == OB_FORCE_LINEAR ? f->point[f->points - 1].t
							 : INFINITY;
	const double first = floor(begins / h);
	if ((double)step + 1 < first)
		return (uint64_t)first;
	return (double)step * h < ends ? step + 1 : UINT64_MAX;
}
