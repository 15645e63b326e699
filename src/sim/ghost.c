#include "sim/ghost.h"

#include <stdlib.h>
#include <string.h>

#include "sim/exchange.h"

bool ob_ghosts_used(const ob_sim *s)
{
	uint32_t exchange = ob_universe_settings(s->u)->solver;
	return exchange == OB_SOLVER_GHOST || exchange == OB_SOLVER_LAGGED;
}

uint32_t ob_ghost_make(ob_sim *s, uint32_t row)
{
	ob_island_work *w = &s->island;
	uint32_t ghost = w->rows++;
	ob_body *m = &w->member[ghost];
	*m = w->member[row];
	if (ob_universe_settings(s->u)->solver == OB_SOLVER_GHOST) {
		m->mass = m->inv_mass = 0;
		memset(m->inv_inertia, 0, sizeof m->inv_inertia);
	}
	m->ghost_of = row;
	m->next_ghost = w->member[row].next_ghost;
	w->member[row].next_ghost = ghost;
	memcpy(w->v[ghost], w->v[row], sizeof *w->v);
	return ghost;
}

void ob_ghosts_follow(ob_sim *s)
{
	ob_island_work *w = &s->island;
	for (uint32_t g = w->first_ghost; g < w->rows; g++) {
		const ob_body *m = &w->member[w->member[g].ghost_of];
		w->member[g].path = m->path;
		w->member[g].speed = m->speed;
		memcpy(w->v[g], w->v[m - w->member], sizeof *w->v);
		memcpy(w->d[g], w->d[m - w->member], sizeof *w->d);
	}
}

void ob_ghosts_read(ob_sim *s, ob_body_row *rows, uint32_t round)
{
	ob_island_work *w = &s->island;
	const ob_run_settings *run = ob_universe_settings(s->u);
	if (!ob_ghosts_used(s))
		return;
	uint32_t kept = run->solver == OB_SOLVER_LAGGED ? run->lag + 1 : 1, late = kept - 1;
	if (kept * w->rows > w->history_max) {
		w->history_max = kept * w->rows * 2;
		w->history = realloc(w->history, w->history_max * sizeof *w->history);
	}
	memcpy(w->history + round % kept * w->rows, rows, w->rows * sizeof *rows);
	const ob_body_row *seen = w->history + (round > late ? round - late : 0) % kept * w->rows;
	for (uint32_t g = w->first_ghost; g < w->rows; g++) {
		uint32_t of = w->member[g].ghost_of;
		memcpy(rows[g], seen[of], sizeof *rows);
		ob_solver_activate(w, g, w->member[of].hot);
	}
}
