#include "solver/machines.h"

#include <string.h>

#include "solver/bodies.h"
#include "solver/budget.h"
#include "solver/joint_load.h"
#include "solver/joint_rows.h"

static uint32_t root_of(uint32_t *root, uint32_t row)
{
	while (root[row] != row)
		row = root[row] = root[root[row]];
	return row;
}

void ob_machines_find(ob_island_work *w)
{
	ob_impacts *x = &w->impacts;
	for (uint32_t row = 0; row < w->rows; row++)
		x->root[row] = x->machine[row] = row, x->slot[row] = OB_NO_SLOT;
	if (!w->elastic || !w->joints.count)
		return;
	for (uint32_t i = 0; i < w->joints.count; i++) {
		const ob_held_joint *j = &w->joints.joint[i];
		if (j->parent != OB_SPARSE_FIXED)
			x->machine[root_of(x->machine, 1 + j->child)] = root_of(x->machine, 1 + j->parent);
	}
	for (uint32_t row = 0; row < w->rows; row++)
		x->machine[row] = root_of(x->machine, row);
}

void ob_machines_join(ob_impacts *x, uint32_t a, uint32_t b)
{
	x->root[ob_machines_set(x, a)] = ob_machines_set(x, b);
}

uint32_t ob_machines_set(ob_impacts *x, uint32_t row)
{
	return root_of(x->root, x->machine[row]);
}

// Exchanges the poses of the set's bodies for those at the instant of the hit, and back.
static void exchange_poses(ob_island_work *w)
{
	ob_impacts *x = &w->impacts;
	for (uint32_t i = 0; i < x->bodies; i++) {
		ob_body *body = &w->body[x->row[i]];
		const ob_vec3 p = body->p;
		const ob_quat q = body->q;
		if (!(body->inv_mass > 0))
			continue;
		ob_body_place(body, x->at[i].p, x->at[i].q);
		x->at[i].p = p, x->at[i].q = q;
	}
}

static void find_rows(ob_island_work *w)
{
	exchange_poses(w);
	ob_joints_find_free(w, w->joints.step_begin + w->time + w->impacts.instant);
	exchange_poses(w);
	w->impacts.found = true;
}

void ob_machines_share(void *solver, ob_impact_change *change)
{
	enum { WORK_OF_JOINT = 8 };
	ob_solver *s = solver;
	ob_island_work *w = &s->island;
	ob_impacts *x = &w->impacts;
	ob_budget_note(s, WORK_OF_JOINT * w->joints.count);
	if (!x->found)
		find_rows(w);
	for (uint32_t i = 0; i < x->bodies; i++)
		if (x->body[i].inv_mass > 0)
			ob_row_add(w->delta[x->row[i]], change[i].v, change[i].w);
	ob_joints_follow(w, w->delta);
	for (uint32_t i = 0; i < x->bodies; i++)
		if (x->body[i].inv_mass > 0)
			change[i] = (ob_impact_change){ ob_row_linear(w->delta[x->row[i]]),
							ob_row_angular(w->delta[x->row[i]]) };
	memset(w->delta, 0, w->rows * sizeof *w->delta);
}

void ob_machines_note_loads(ob_island_work *w)
{
	if (!w->impacts.found) // no point approached
		return;
	ob_joints_add_share(w, 1);
	ob_joint_loads_keep(&w->joints);
}
