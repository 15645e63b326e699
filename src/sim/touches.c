#include "sim/touches.h"

// The cell of a body whose script has an on_contact; NULL: it has none.
static ob_script_cell *cell_that_feels(const ob_step_data *data, uint32_t id, ob_script_turn **turn)
{
	const uint32_t cell = data->script_of[id];
	if (!cell || data->schedule[id].state < OB_SCHEDULE_AWAKE)
		return NULL;
	*turn = &data->script_turn[cell - 1];
	return (*turn)->flags & OB_SCRIPT_FEELS ? &data->script_cell[cell - 1] : NULL;
}

void ob_touches_begin(ob_sim *s, const ob_island *is)
{
	const ob_step_data *data = s->data;
	ob_script_turn *turn;
	s->island.feels = false;
	for (uint32_t i = 0; data->script_of && i < is->members; i++) {
		ob_script_cell *c = cell_that_feels(data, data->member[is->first_member + i], &turn);
		if (!c)
			continue;
		s->island.feels = true;
		turn->flags &= ~(uint32_t)OB_SCRIPT_TOUCHED;
		c->touches = 0;
	}
}

static void note(ob_sim *s, uint32_t id, uint32_t other, double impulse, ob_vec3 point)
{
	ob_script_turn *turn;
	ob_script_cell *c = cell_that_feels(s->data, id, &turn);
	uint32_t i = 0;
	if (!c)
		return;
	turn->flags |= OB_SCRIPT_TOUCHED;
	while (i < c->touches && c->touch[i].other != other)
		i++;
	if (i == OB_SCRIPT_TOUCHES)
		return;
	if (i == c->touches)
		c->touch[c->touches++] = (ob_script_touch){ .other = other,
							    .generation = ob_passport_of(s->u, other)->generation,
							    .point = point };
	c->touch[i].impulse += impulse;
}

void ob_touches_note(ob_sim *s, uint32_t a, uint32_t b, double impulse, ob_vec3 point)
{
	if (!s->data->script_of)
		return;
	note(s, a, b, impulse, point);
	note(s, b, a, impulse, point);
}

void ob_touches_note_solved(ob_sim *s)
{
	const ob_island_work *w = &s->island;
	for (uint32_t i = 0; w->feels && i < w->contacts; i++) {
		const ob_contact *c = &w->contact[i];
		if (c->lane == OB_NO_LANE || c->mirror || !c->began)
			continue;
		const ob_batch *b = &w->batch[c->lane / OB_LANES];
		double impulse = 0;
		ob_vec3 point = { 0 };
		for (uint32_t j = 0; j < c->points; j++) {
			impulse += b->impulse[j][c->lane % OB_LANES];
			point = ob_madd(point, 1. / c->points, ob_add(w->body[c->a].p, c->arm_a[j]));
		}
		if (impulse > 0)
			ob_touches_note(s, w->body[c->a].id, w->body[c->b].id, impulse, point);
	}
}

// Where a body is hit in several places at once, each is told the change of its momentum in its own direction.
void ob_touches_note_impact(ob_sim *s, const ob_impact_instant *i)
{
	const ob_island_work *w = &s->island;
	const ob_impacts *x = &w->impacts;
	const ob_contact *c = &w->contact[i->contact];
	if (!w->feels || c->mirror || !c->began || !i->m.points)
		return;
	const uint32_t row = w->body[c->a].inv_mass >= w->body[c->b].inv_mass ? c->a : c->b, k = x->slot[row];
	const ob_vec3 change = ob_sub(x->body[k].v, x->before[k].v);
	ob_vec3 point = { 0 };
	for (int j = 0; j < i->m.points; j++)
		point = ob_madd(point, 1. / i->m.points, i->m.at[j]);
	ob_touches_note(s, w->body[c->a].id, w->body[c->b].id,
			fabs(ob_dot(change, i->m.normal)) / w->body[row].inv_mass, point);
}
