// ODE's bodies, each in a world of its own, by which a worker steps objects. A body's state is set before each step, so
// it can be made anew at any time, and any worker may have one. All workers together keep no more than there are
// objects, or a few for each: a worker that claims islands solves, in the course of a run, every object.
//
// Thread-safety: private to its worker.
#ifndef OB_SIM_ODE_BODIES_H
#define OB_SIM_ODE_BODIES_H

#include "ode/ode_body.h"
#include "table/table.h"

typedef struct ob_ode_bodies {
	ob_ode_stepper *stepper; // shared by all of them
	uint32_t slots;
	struct ob_ode_slot *slot; // [slots], by id: a later body replaces an earlier one
} ob_ode_bodies;

bool ob_ode_bodies_create(ob_ode_bodies *w, const ob_universe *u); // false: no memory
void ob_ode_bodies_finish(ob_ode_bodies *w);

// Returns the object's body. Valid until the next call.
ob_ode_body *ob_ode_bodies_get(ob_ode_bodies *w, const ob_universe *u, uint32_t id);

#endif
