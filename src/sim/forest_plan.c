// When is a direct solve worth its cost?
#include <stdlib.h>

#include "sim/worker.h"

enum { NOBODY = UINT32_MAX };

static const double noticeable = 2e-3, finest = 1e-6; // m/s: what rounds alone leave over; what anything may be asked
static const double enough = 8; // times its own mass: who carries less is served well by rounds
static const double calm = .1; // m/s: what moves faster, falls or slides

void ob_forest_begin(ob_forest *f)
{
	f->planned = f->recent = f->hopeless = false;
}

void ob_forest_finish(ob_forest *f)
{
	free(f->link);
	free(f->order);
	free(f->up);
	free(f->carried);
	free(f->contact);
	free(f->rate);
	free(f->change);
}

static void reserve(ob_forest *f, const ob_island_work *w)
{
	if (w->rows > f->rows_max) {
		f->rows_max = w->rows + w->rows / 2;
		f->link = realloc(f->link, f->rows_max * sizeof *f->link);
		f->order = realloc(f->order, f->rows_max * sizeof *f->order);
		f->up = realloc(f->up, f->rows_max * sizeof *f->up);
		f->carried = realloc(f->carried, f->rows_max * sizeof *f->carried);
		f->contact = realloc(f->contact, f->rows_max * sizeof *f->contact);
	}
	if (w->batches > f->batches_max) {
		f->batches_max = w->batches + w->batches / 2;
		free(f->rate);
		free(f->change);
		f->rate = aligned_alloc(32, f->batches_max * sizeof *f->rate);
		f->change = aligned_alloc(32, f->batches_max * sizeof *f->change);
	}
}

static bool stands_still(const ob_island_work *w)
{
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_touch *t = &w->touch[i];
		double speed2 = 0;
		for (int c = 0; c < 3; c++) {
			double d = w->v[t->a][c] - w->v[t->b][c];
			speed2 += d * d;
		}
		if (t->lane != OB_NO_LANE && speed2 > calm * calm)
			return false;
	}
	return true;
}

// Breadth-first from the fixed bodies: up[] of every row that is carried, order[] of their rows. Returns how many.
static uint32_t climb(ob_island_work *w)
{
	ob_forest *f = &w->forest;
	uint32_t n = 0;
	for (uint32_t i = 0; i < w->rows; i++)
		f->up[i] = NOBODY;
	for (uint32_t i = 0; i < w->touches; i++) {
		const ob_touch *t = &w->touch[i];
		bool a_fixed = w->member[t->a].inv_mass == 0, b_fixed = w->member[t->b].inv_mass == 0;
		uint32_t at = a_fixed ? t->b : t->a;
		if (t->lane != OB_NO_LANE && (a_fixed || b_fixed) && f->up[at] == NOBODY) {
			f->up[at] = 0;
			f->order[n++] = at;
		}
	}
	for (uint32_t done = 0; done < n; done++) {
		const ob_member *m = &w->member[f->order[done]];
		for (uint32_t k = 0; k < m->adjacent; k++) {
			const ob_touch *t = &w->touch[w->adjacency[m->first_adjacent + k]];
			uint32_t other = t->a == f->order[done] ? t->b : t->a;
			if (t->lane != OB_NO_LANE && w->member[other].inv_mass > 0 && f->up[other] == NOBODY) {
				f->up[other] = f->order[done];
				f->order[n++] = other;
			}
		}
	}
	return n;
}

// The most that any body carries, itself included, times its own mass
static double heaviest_load(ob_island_work *w)
{
	ob_forest *f = &w->forest;
	double most = 0;
	uint32_t n = climb(w);
	for (uint32_t i = 0; i < w->rows; i++)
		f->carried[i] = w->member[i].mass;
	while (n-- > 0) {
		uint32_t at = f->order[n];
		most = fmax(most, f->carried[at] * w->member[at].inv_mass);
		f->carried[f->up[at]] += f->carried[at]; // row 0 takes what the roots carry
	}
	return most;
}

// Rounds leave an error of about load^2 times what they show. Where contacts close cycles, the forest would ask one
// contact for what several carry; then rounds alone do better.
static double tolerance(ob_island_work *w)
{
	uint32_t touching = 0;
	for (uint32_t i = 0; i < w->touches; i++)
		touching += w->touch[i].lane != OB_NO_LANE;
	if (touching > w->members)
		return INFINITY;
	double load = heaviest_load(w);
	return load < enough ? INFINITY : fmax(finest, noticeable / (load * load));
}

// After a direct solve the next substep is solved finely, too. The correction of what had gone wrong is a part of the
// change of velocity that the prediction repeats: left alone it would go on for ever, to and fro.
bool ob_forest_asked(ob_sim *s, double left)
{
	ob_island_work *w = &s->island;
	ob_forest *f = &w->forest;
	const double finer = .01;
	if (left <= finer * finest || f->hopeless || ob_universe_settings(s->u)->exchange != OB_EXCHANGE_COLOURED)
		return false;
	reserve(f, w);
	if (!f->planned)
		f->tolerance = tolerance(w);
	f->planned = true;
	return left > f->tolerance * (f->recent ? finer : 1) && stands_still(w);
}
