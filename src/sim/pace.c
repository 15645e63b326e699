#include "sim/pace.h"

#include <string.h>

#include "sim/exchange.h"
#include "sim/look.h"
#include "sim/members.h"

static const double followed = .03; // so far may two bodies that touch turn (rad) and slide (smaller thicknesses) ..
static const double closely =
	1. / 10; // .. in a stride; of that, where they get farther than their thickness in a substep
static const double most_strides = 1024; // of a substep

static ob_vec3 linear_of(const double *r)
{
	return ob_v3(r[0], r[1], r[2]);
}

static double turn_rate(const ob_island_work *w, const ob_body_row *rows, uint32_t row)
{
	const double *v = rows[row];
	return w->member[row].shape == OB_SHAPE_SPHERE ? 0 : ob_norm(ob_v3(v[3], v[4], v[5]));
}

// For how long a contact's points and normal are where they are now (s), at the velocities in rows. A sphere's point
// moves with its centre, and a plane is the same everywhere.
static double lasting(const ob_island_work *w, const ob_body_row *rows, const ob_contact *t)
{
	const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
	double turn = turn_rate(w, rows, t->a) + turn_rate(w, rows, t->b);
	double slide = ob_norm(ob_sub(linear_of(rows[t->a]), linear_of(rows[t->b])));
	if (a->shape == OB_SHAPE_PLANE || b->shape == OB_SHAPE_PLANE)
		slide = 0;
	double thin = fmin(a->thickness, b->thickness), way = (slide + .5 * thin * turn) * w->substep;
	double part = followed * fmax(closely, fmin(1, thin / way));
	return fmin(part / turn, part * thin / slide);
}

static bool may_be_short(const ob_island_work *w, const ob_contact *t, double h)
{
	const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
	return (a->speed + b->speed) * h > followed * fmin(a->thickness, b->thickness);
}

double ob_adaptive_shortest(const ob_island_work *w)
{
	return w->substep / most_strides;
}

static double length_of_stride(ob_sim *s, double left)
{
	ob_island_work *w = &s->island;
	const double least = ob_adaptive_shortest(w);
	double h = left;
	for (uint32_t i = 0; i < w->touches; i++)
		if (w->touch[i].lane != OB_NO_LANE && may_be_short(w, &w->touch[i], h))
			h = fmin(h, fmax(least, lasting(w, w->v, &w->touch[i])));
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_contact *t = &w->touch[i];
		const ob_body *a = &w->member[t->a], *b = &w->member[t->b];
		if (t->lane != OB_NO_LANE || !may_be_short(w, t, h) ||
		    a->path + b->path + (a->speed + b->speed) * h <= t->limit)
			continue;
		ob_body_update_pose(w, t->a);
		ob_body_update_pose(w, t->b);
		h = fmin(h, fmax(fmax(least, lasting(w, w->v, t)), ob_narrowphase_time_of_impact(s, t, h)));
	}
	return left - h < .5 * h && left < 1.5 * least ? left : h;
}

// What the last stride brought, the next is predicted to bring in proportion.
static void rescale(ob_island_work *w, double h)
{
	double factor = h / w->h;
	w->h = h;
	if (factor == 1)
		return;
	for (uint32_t i = 0; i < w->batches; i++)
		for (int k = 0; k < OB_ROWS; k++)
			w->batch[i].impulse[k] *= factor;
}

void ob_adaptive_begin(ob_sim *s, double left)
{
	rescale(&s->island, length_of_stride(s, left));
	s->island.last_impact = 0;
}

void ob_adaptive_end_at_rebound(ob_sim *s)
{
	ob_island_work *w = &s->island;
	double first = fmax(ob_solver_first_rebound(s) * (1 - 1e-9), w->last_impact);
	if (!(first > ob_adaptive_shortest(w) && first < w->h))
		return;
	rescale(w, first);
	ob_bodies_warm_start(s);
}

bool ob_adaptive_shorten(ob_sim *s)
{
	ob_island_work *w = &s->island;
	double h = w->h;
	bool hit = false;
	for (uint32_t i = 0; i < w->batches; i++)
		hit |= w->batch[i].impact != 0;
	for (uint32_t i = 0; hit && i < w->touches; i++)
		h = fmin(h, lasting(w, w->u, &w->touch[i]));
	h = fmax(fmax(h, ob_adaptive_shortest(w)), w->last_impact); // what has bounced must get to where it did
	if (h > .6 * w->h)
		return false;
	for (uint32_t i = 0; i < w->batches; i++)
		memcpy(w->batch[i].impulse, w->batch[i].impulse_start, sizeof w->batch[i].impulse);
	rescale(w, h);
	ob_bodies_warm_start(s);
	return true;
}
