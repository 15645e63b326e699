#include "solver/ode_bodies.h"

#include <stdlib.h>

typedef struct ob_ode_slot {
	ob_ode_body *body; // NULL: none yet
	uint32_t id, generation;
} ob_ode_slot;

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
		ob_ode_body_destroy(w->slot[i].body);
	ob_ode_stepper_destroy(w->stepper);
	free(w->slot);
}

ob_ode_body *ob_ode_bodies_get(ob_ode_bodies *w, ob_vec3 gravity, uint32_t id, const ob_passport *p)
{
	ob_ode_slot *slot = &w->slot[id % w->slots];
	if (!slot->body || slot->id != id || slot->generation != p->generation) {
		ob_ode_body_destroy(slot->body);
		*slot = (ob_ode_slot){ ob_ode_body_create(p, gravity, w->stepper), id, p->generation };
	}
	return slot->body;
}
