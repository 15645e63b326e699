// When is a direct solve worth its cost?
#include <stdlib.h>

#include "sim/worker.h"

static const double finest = 1e-7, after_correction = 1e-8; // m/s: what may be left over
static const double calm = .02; // m/s: what moves faster, falls or slides

void ob_forest_begin(ob_forest *f)
{
	f->recent = f->hopeless = false;
}

void ob_forest_finish(ob_forest *f)
{
	free(f->link);
	free(f->order);
	free(f->up);
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
		if (t->lane == OB_NO_LANE)
			continue;
		for (int c = 0; c < 3; c++) {
			double d = w->v[t->a][c] - w->v[t->b][c];
			speed2 += d * d;
		}
		if (speed2 > calm * calm)
			return false;
	}
	return true;
}

// Where contacts close cycles, the forest would ask one contact for what several carry; then rounds alone do better.
static bool closes_cycles(const ob_island_work *w)
{
	uint32_t touching = 0;
	for (uint32_t i = 0; i < w->touches; i++)
		touching += w->touch[i].lane != OB_NO_LANE;
	return touching > w->members;
}

// After a direct solve the next substep is solved finely, too. The correction of what had gone wrong is a part of the
// change of velocity that the prediction repeats: left alone it would go on for ever, to and fro.
bool ob_forest_asked(ob_sim *s, double left)
{
	ob_island_work *w = &s->island;
	ob_forest *f = &w->forest;
	if (left <= (f->recent ? after_correction : finest) || f->hopeless || f->fit == OB_FOREST_UNFIT ||
	    ob_universe_settings(s->u)->exchange != OB_EXCHANGE_COLOURED)
		return false;
	if (f->fit == OB_FOREST_UNKNOWN)
		f->fit = closes_cycles(w) || !stands_still(w) ? OB_FOREST_UNFIT : OB_FOREST_FIT;
	if (f->fit == OB_FOREST_UNFIT)
		return false;
	reserve(f, w);
	return true;
}
