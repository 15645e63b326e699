#include "solver/touches.h"

// From the frame in which the island is solved; t: s into the partial substep.
static ob_vec3 in_world(const ob_island_work *w, ob_vec3 point, double t)
{
	return ob_madd(point, .5 * (w->time + t) * (w->time + t), w->frame);
}

void ob_touches_note_solved(ob_solver *s)
{
	const ob_island_work *w = &s->island;
	for (uint32_t i = 0; s->in->feels && i < w->contacts; i++) {
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
			s->calls.touch(s->calls.with, w->body[c->a].id, w->body[c->b].id, impulse,
				       in_world(w, point, 0));
	}
}

// A body hit in several places at once gets for each the change of its momentum in that direction.
void ob_touches_note_impact(ob_solver *s, const ob_impact_instant *i)
{
	const ob_island_work *w = &s->island;
	const ob_impacts *x = &w->impacts;
	const ob_contact *c = &w->contact[i->contact];
	if (!s->in->feels || c->mirror || !c->began || !i->m.points)
		return;
	const uint32_t row = w->body[c->a].inv_mass >= w->body[c->b].inv_mass ? c->a : c->b, k = x->slot[row];
	const ob_vec3 change = ob_sub(x->body[k].v, x->before[k].v);
	ob_vec3 point = { 0 };
	for (int j = 0; j < i->m.points; j++)
		point = ob_madd(point, 1. / i->m.points, i->m.at[j]);
	s->calls.touch(s->calls.with, w->body[c->a].id, w->body[c->b].id,
		       fabs(ob_dot(change, i->m.normal)) / w->body[row].inv_mass, in_world(w, point, i->time));
}
