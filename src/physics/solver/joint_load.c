#include "solver/joint_load.h"

#include <math.h>
#include <string.h>

static ob_joint_action sum_of(const ob_joint_action *a, const ob_joint_action *b)
{
	return (ob_joint_action){ ob_add(a->force, b->force), ob_add(a->torque, b->torque), a->along + b->along };
}

void ob_joint_note_row(ob_held_joint *j, uint32_t r, double impulse)
{
	const double *row = j->end[0].row ? j->rows.child[r] : j->rows.parent[r];
	const ob_vec3 pull = ob_row_linear(row);
	ob_joint_action *a = &j->action.now;
	if (ob_norm2(pull) > 0) // it acts at the joint's origin
		a->force = ob_madd(a->force, impulse, pull);
	else
		a->torque = ob_madd(a->torque, impulse, ob_row_angular(row));
	if (r >= j->base)
		a->along += impulse;
}

void ob_joint_note(ob_held_joint *j, const double *impulse)
{
	for (uint32_t r = 0; r < j->rows.rows; r++)
		ob_joint_note_row(j, r, impulse[r]);
}

void ob_joint_loads_begin(ob_joint_set *set)
{
	for (uint32_t i = 0; i < set->count; i++)
		set->joint[i].action.now = (ob_joint_action){ .along = 0 };
}

void ob_joint_loads_keep(ob_joint_set *set)
{
	for (uint32_t i = 0; i < set->count; i++)
		set->joint[i].action.kept = set->joint[i].action.now;
}

void ob_joint_loads_put_back(ob_joint_set *set)
{
	for (uint32_t i = 0; i < set->count; i++)
		set->joint[i].action.now = set->joint[i].action.kept;
}

// Returns the end of the parts that follow a joint.
static const ob_held_joint *end_of_parts(const ob_joint_set *set, const ob_held_joint *j)
{
	const ob_held_joint *end = j + 1;
	while (end < set->joint + set->count && end->part)
		end++;
	return end;
}

ob_held_joint *ob_joint_loads_weakest(ob_joint_set *set, double h)
{
	ob_held_joint *weakest = NULL;
	double most = 1;
	for (uint32_t i = 0; set->breakable && i < set->count; i++) {
		ob_held_joint *j = &set->joint[i];
		if (j->part)
			continue;
		ob_joint_action now = j->action.now;
		for (const ob_held_joint *p = j + 1; p < end_of_parts(set, j); p++)
			now = sum_of(&now, &p->action.now);
		const double share = ob_max(ob_norm(now.force) / (h * j->breaks_force),
					    ob_norm(now.torque) / (h * j->breaks_torque));
		if (!j->broken && share > most)
			most = share, weakest = j;
	}
	return weakest;
}

static void break_one(ob_island_work *w, ob_held_joint *j, double h)
{
	j->broken = true;
	j->action.whole = j->action.now, j->action.time = h;
	j->action.now = j->action.kept = (ob_joint_action){ .along = 0 };
	w->joints.axes -= j->axis != NULL;
	j->axis = NULL;
	memset(&j->along, 0, sizeof j->along);
	j->base = j->rows.rows = 0;
}

void ob_joint_break(ob_island_work *w, ob_held_joint *j, double h)
{
	const ob_held_joint *end = end_of_parts(&w->joints, j);
	for (ob_held_joint *x = j; x < end; x++)
		break_one(w, x, h);
	for (int side = 0; side < 2; side++)
		if (j->end[side].row)
			w->body[j->end[side].row].joints--;
}

void ob_joint_loads_end(ob_joint_set *set)
{
	for (uint32_t i = 0; i < set->count; i++) {
		ob_held_joint *j = &set->joint[i];
		if (!j->broken)
			j->action.whole = sum_of(&j->action.whole, &j->action.now);
		j->action.now = j->action.kept = (ob_joint_action){ .along = 0 };
	}
}

void ob_joint_loads_report(ob_solver *s)
{
	const ob_joint_set *set = &s->island.joints;
	for (uint32_t i = 0; i < set->count; i++) {
		const ob_held_joint *j = &set->joint[i];
		if (j->part)
			continue;
		ob_joint_action all = j->action.whole, *a = &all;
		for (const ob_held_joint *p = j + 1; p < end_of_parts(set, j); p++) {
			all = sum_of(&all, &p->action.whole);
			all.along -= p->kind == OB_JOINT_UNIVERSAL && p->part == 1 ? 0 : p->action.whole.along;
		}
		const double share = 1 / (j->broken ? j->action.time : s->settings->step_length);
		s->calls.joint(s->calls.with, &(ob_found_joint){ .joint = s->in->joint[j->number].number,
								 .broke = j->broken,
								 .force = ob_scale(a->force, share),
								 .torque = ob_scale(a->torque, share),
								 .along = share * a->along });
	}
}
