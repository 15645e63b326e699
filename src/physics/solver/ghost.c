#include "solver/ghost.h"

#include "base/allocate.h"
#include "solver/bodies.h"
#include "solver/contact_solver.h"
#include "solver/contacts.h"

#include <stdlib.h>
#include <string.h>

// Adds a row that stands for body "row" towards one of its neighbours. Returns the new row.
static uint32_t make_ghost(ob_solver *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	const uint32_t ghost = ob_bodies_add_row(w);
	ob_body *body = &w->body[ghost];
	*body = w->body[row];
	if (s->settings->solver == OB_SOLVER_GHOST) {
		body->mass = body->inv_mass = 0;
		memset(body->inv_inertia, 0, sizeof body->inv_inertia);
	}
	body->ghost_of = row;
	body->next_ghost = w->body[row].next_ghost;
	w->body[row].next_ghost = ghost;
	memcpy(w->v[ghost], w->v[row], sizeof *w->v);
	return ghost;
}

void ob_ghosts_load(ob_solver *s, const ob_island_pair *pair)
{
	ob_island_work *w = &s->island;
	ob_contact *own = &w->contact[w->contacts], *mirror = own + 1;
	const bool two = own->a <= w->bodies && own->b <= w->bodies;
	if (two) {
		*mirror = *own;
		own->b = make_ghost(s, own->b);
		mirror->a = make_ghost(s, mirror->a);
		mirror->mirror = true;
	}
	ob_contact_load(s, pair);
	if (two)
		ob_contact_load(s, pair);
}

void ob_ghosts_follow(ob_solver *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t g = w->first_ghost; g < w->rows; g++) {
		const ob_body *body = &w->body[w->body[g].ghost_of];
		w->body[g].path = body->path;
		w->body[g].speed = body->speed;
		w->body[g].turning = body->turning;
		memcpy(w->v[g], w->v[body - w->body], sizeof *w->v);
		memcpy(w->d[g], w->d[body - w->body], sizeof *w->d);
	}
}

bool ob_ghosts_read(ob_solver *s, ob_body_row *rows, uint32_t iteration)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = s->settings;
	uint32_t kept = run->solver == OB_SOLVER_LAGGED ? run->lag + 1 : 1, late = kept - 1;
	if (kept * w->rows > w->history_max) {
		w->history_max = kept * w->rows * 2;
		w->history = ob_reallocate(w->history, w->history_max * sizeof *w->history);
	}
	memcpy(w->history + iteration % kept * w->rows, rows, w->rows * sizeof *rows);
	const ob_body_row *seen = w->history + (iteration > late ? iteration - late : 0) % kept * w->rows;
	for (uint32_t g = w->first_ghost; g < w->rows; g++)
		memcpy(rows[g], seen[w->body[g].ghost_of], sizeof *rows);
	for (uint32_t g = w->first_ghost; g < w->rows; g++)
		ob_solver_activate(w, g, w->body[w->body[g].ghost_of].active_iteration);
	return true;
}
