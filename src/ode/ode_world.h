// The monolith: one ODE world that holds every object, as a usual virtual environment does it.
#ifndef OB_ODE_WORLD_H
#define OB_ODE_WORLD_H

#include <ob/motion.h>

typedef struct ob_ode_world ob_ode_world;
typedef struct ob_ode_world_setup {
	ob_vec3 gravity;
	uint32_t iterations; // QuickStep; 0 = dWorldStep (the big-matrix solver)
	uint32_t objects;    // ids are 0 .. objects-1
	bool sleeping;       // ODE's auto-disable
} ob_ode_world_setup;

ob_ode_world *ob_ode_world_create(const ob_ode_world_setup *s);
void ob_ode_world_destroy(ob_ode_world *w);
void ob_ode_world_add(ob_ode_world *w, const ob_passport *p, const ob_state *s);
void ob_ode_world_remove(ob_ode_world *w, uint32_t id);
// Collides (sweep-and-prune space) and steps by h (s).
void ob_ode_world_step(ob_ode_world *w, double h);
void ob_ode_world_get(const ob_ode_world *w, uint32_t id, ob_state *s, bool *asleep, bool *touching);
// Contact points of the last step; returns how many there are (may exceed max).
size_t ob_ode_world_contacts(const ob_ode_world *w, ob_contact_point *out, size_t max);

#endif
