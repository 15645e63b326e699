#include "solver/ode_bodies.h"

#include <stdlib.h>
#include <string.h>

#include "elementary/elementary.h"
#include "solver/bodies.h"

bool ob_ode_bodies_create(ob_ode_bodies *w, uint32_t objects)
{
	w->slots = objects;
	w->stepper = ob_ode_stepper_create();
	w->slot = calloc(w->slots, sizeof *w->slot);
	return w->stepper && w->slot;
}

void ob_ode_bodies_finish(ob_ode_bodies *w)
{
	for (uint32_t i = 0; w->slot && i < w->slots; i++)
		ob_ode_body_destroy(w->slot[i]);
	ob_ode_stepper_destroy(w->stepper);
	free(w->slot);
}

ob_ode_body *ob_ode_bodies_get(ob_ode_bodies *w, ob_vec3 gravity, uint32_t id, const ob_passport *p)
{
	ob_ode_body **slot = &w->slot[id % w->slots];
	if (!*slot || !ob_ode_body_serves(*slot, p)) {
		ob_ode_body_destroy(*slot);
		*slot = ob_ode_body_create(p, gravity, w->stepper);
	}
	return *slot;
}

void ob_ode_bodies_move(ob_solver *s, uint32_t row, double smooth)
{
	ob_island_work *w = &s->island;
	ob_body *body = &w->body[row];
	ob_vec3 g = ob_scale(s->settings->gravity, w->h);
	double change[6];
	for (int c = 0; c < 6; c++)
		change[c] = w->u[row][c] - w->v[row][c];
	ob_vec3 j = ob_scale(ob_sub(ob_row_linear(change), g), body->mass),
		wl = ob_rotate_back(&body->r, ob_row_angular(change));
	ob_vec3 l = ob_rotate(&body->r, ob_v3(wl.x * body->inertia.x, wl.y * body->inertia.y, wl.z * body->inertia.z));
	ob_state state = { { body->p, body->q }, ob_row_linear(w->v[row]), ob_row_angular(w->v[row]) };
	ob_pose before = state.pose;
	if (!ob_ode_body_step(
		    ob_ode_bodies_get(&s->ode_bodies, s->settings->gravity, body->id, s->in->object[row - 1].passport),
		    &state, j, l, w->h))
		s->calls.fail(s->calls.with, body->id);
	// The displacement row takes ODE's step, so that the gaps follow.
	ob_row_add(w->d[row], ob_sub(state.pose.p, before.p), ob_turn_between(before.q, state.pose.q));
	memset(w->u[row], 0, sizeof(ob_body_row));
	ob_row_add(w->u[row], state.v, state.w);
	ob_body_update_pose(w, row);
	memcpy(w->v[row], w->u[row], sizeof *w->v);
}
