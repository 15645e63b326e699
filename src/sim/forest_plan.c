// When is a direct solve worth its cost?
#include <stdlib.h>

#include "sim/state.h"

static const double finest = 1e-7, after_correction = 1e-8; // m/s: what may be left over
static const int most = 4, most_in_cycles = 16; // direct solves in a stride
static const double creeping = 1e-4; // m/s: whose contacts hold and which is slower, ought to stand
static const double calm = .02; // m/s: what moves faster, falls or slides

void ob_direct_begin(ob_direct_solver *f)
{
	f->recent = f->hopeless = false;
}

void ob_direct_begin_partial(ob_direct_solver *f)
{
	f->fit = OB_DIRECT_UNKNOWN;
	f->solved = 0;
	f->left[0] = f->left[1] = INFINITY;
}

void ob_direct_finish(ob_direct_solver *f)
{
	free(f->link);
	free(f->order);
	free(f->up);
	free(f->contact);
	free(f->rate);
	free(f->change);
	ob_sparse_finish(&f->truss);
}

static void reserve(ob_direct_solver *f, const ob_island_work *w)
{
	if (w->rows > f->rows_max) {
		f->rows_max = w->rows + w->rows / 2;
		f->link = realloc(f->link, f->rows_max * sizeof *f->link);
		f->order = realloc(f->order, f->rows_max * sizeof *f->order);
		f->up = realloc(f->up, f->rows_max * sizeof *f->up);
	}
	if (w->touches > f->contacts_max) {
		f->contacts_max = w->touches + w->touches / 2;
		free(f->contact);
		f->contact = malloc(f->contacts_max * sizeof *f->contact);
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
		const ob_contact *t = &w->touch[i];
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

// Where contacts close cycles, a forest would ask one contact for what several carry.
static bool closes_cycles(const ob_island_work *w)
{
	uint32_t touching = 0;
	for (uint32_t i = 0; i < w->touches; i++)
		touching += w->touch[i].lane != OB_NO_LANE;
	return touching > w->members;
}

// Now and then, for what one solve does not bring to rest the next one seldom does; and in two steps running, for what
// is corrected in the first is predicted again in the second.
static bool worth_a_try(const ob_sim *s)
{
	const uint32_t every = 8, most_members = 256;
	return ob_step_count(s->u) % every < 2 && s->island.members <= most_members;
}

// Does something move that ought to stand? Rounds do not see it: what sways as a whole changes little from pair to
// pair.
static bool creeps(const ob_island_work *w)
{
	double fastest2 = 0;
	for (uint32_t i = 1; i <= w->members; i++) {
		const double *u = w->u[i];
		fastest2 = fmax(fastest2, u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
	}
	return fastest2 > finest * finest && fastest2 < creeping * creeping;
}

static bool is_worth_while(const ob_sim *s, double left)
{
	const ob_direct_solver *f = &s->island.forest;
	if (f->hopeless || f->fit == OB_DIRECT_UNFIT || ob_universe_settings(s->u)->solver != OB_SOLVER_COLOURED)
		return false;
	// After a direct solve the next substep is solved finely, too. The correction of what had gone wrong is a part
	// of the change of velocity that the prediction repeats: left alone it would go on for ever, to and fro.
	const double enough = f->recent && f->fit != OB_DIRECT_CYCLIC ? after_correction : finest;
	return left > enough || (!f->solved && creeps(&s->island));
}

bool ob_direct_wanted(ob_sim *s, double left, bool rounds_go_on)
{
	ob_island_work *w = &s->island;
	ob_direct_solver *f = &w->forest;
	if (!is_worth_while(s, left))
		return false;
	if (f->fit == OB_DIRECT_UNKNOWN)
		f->fit = !stands_still(w)    ? OB_DIRECT_UNFIT
			 : !closes_cycles(w) ? OB_DIRECT_FOREST
			 : worth_a_try(s)    ? OB_DIRECT_CYCLIC
					     : OB_DIRECT_UNFIT;
	const bool cyclic = f->fit == OB_DIRECT_CYCLIC;
	if (f->fit == OB_DIRECT_UNFIT || f->solved == (cyclic ? most_in_cycles : most) || (cyclic && rounds_go_on))
		return false;
	if (cyclic && left > .5 * f->left[1]) {
		f->hopeless = true;
		return false;
	}
	f->left[1] = f->left[0];
	f->left[0] = left;
	f->solved++;
	reserve(f, w);
	return true;
}
