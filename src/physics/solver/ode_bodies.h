// ODE's bodies, each in a world of its own, that a solver moves objects with where the run's integrator is ODE's. A body's
// state is set before each step, so it can be made anew at any time. Thread-safety: one thread.
#ifndef OB_SOLVER_ODE_BODIES_H
#define OB_SOLVER_ODE_BODIES_H

#include "ode/ode_body.h"

typedef struct ob_ode_bodies {
	ob_ode_stepper *stepper; // shared by all bodies
	uint32_t slots;
	ob_ode_body **slot; // [slots], by id: a later one takes an earlier one's place; NULL: none yet
} ob_ode_bodies;

bool ob_ode_bodies_create(ob_ode_bodies *w, uint32_t objects); // keeps so many; false: no memory
void ob_ode_bodies_finish(ob_ode_bodies *w);

// Returns the body of object id, made from its passport. Valid until the next call. gravity: m/s^2.
ob_ode_body *ob_ode_bodies_get(ob_ode_bodies *w, ob_vec3 gravity, uint32_t id, const ob_passport *p);

// Moves a body of an island by ODE: the impulses of the partial substep enter as a force. ob_methods.move.
struct ob_solver;
void ob_ode_bodies_move(struct ob_solver *s, uint32_t row, double smooth);

#endif
