#include "sim/ode_bodies.h"

#include <stdlib.h>

enum { SLOTS_MIN = 256 }; // for the members of an island, however large a universe is: .35 MB

typedef struct ob_ode_slot {
	ob_ode_body *body; // NULL: not made yet
	uint32_t id, generation;
} ob_ode_slot;

bool ob_ode_bodies_create(ob_ode_bodies *w, const ob_universe *u)
{
	const uint32_t objects = ob_universe_capacity(u), workers = ob_universe_workers(u);
	w->slots = objects / workers + (objects % workers != 0);
	if (w->slots < SLOTS_MIN)
		w->slots = objects < SLOTS_MIN ? objects : SLOTS_MIN;
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

ob_ode_body *ob_ode_bodies_get(ob_ode_bodies *w, const ob_universe *u, uint32_t id)
{
	const ob_passport *p = ob_passport_of(u, id);
	ob_ode_slot *slot = &w->slot[id % w->slots];
	if (!slot->body || slot->id != id || slot->generation != p->generation) {
		ob_ode_body_destroy(slot->body);
		*slot = (ob_ode_slot){ ob_ode_body_create(p, ob_universe_settings(u)->gravity, w->stepper), id,
				       p->generation };
	}
	return slot->body;
}
