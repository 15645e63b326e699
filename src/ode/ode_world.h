// The baseline: one ODE world that holds every object, as a usual virtual environment does it: sweep-and-prune space,
// up to 4 contact points a pair (8 with a cylinder), friction pyramid, ODE's own parameters throughout.
//
// Thread-safety: one thread at a time per world. QuickStep shuffles its rows by a seed of the whole process, which each
// step sets anew: the same bits in every run, as long as no other world of the process steps at the same time.
#ifndef OB_ODE_WORLD_H
#define OB_ODE_WORLD_H

#include <ob/motion.h>

typedef struct ob_ode_world ob_ode_world;
typedef struct ob_ode_world_setup {
	ob_vec3 gravity;
	uint32_t iterations; // QuickStep; 0 = dWorldStep (the big-matrix solver)
	uint32_t objects; // ids are 0 .. objects-1
	bool sleeping; // ODE's auto-disable
	bool boxed; // contacts are those of the axis-aligned boxes round the objects
	uint32_t pairs_max; // of objects in contact, in a step; 0 = as many as there is memory for
	uint32_t load; // ob_synthetic_load, at each pair of boxes that the space finds to overlap
	bool hashed; // pairs are found by a hash space instead of sweep and prune
	double surface_layer; // m, that contacts may sink in; 0 = ODE's default, as with those below
	double softness; // constraint force mixing (kg^-1) of all constraints
	double correcting_speed; // m/s, at most, at which penetration is undone
} ob_ode_world_setup;

ob_ode_world *ob_ode_world_create(const ob_ode_world_setup *s); // NULL: no memory
void ob_ode_world_destroy(ob_ode_world *w); // NULL is allowed
// p->id must be free.
void ob_ode_world_add(ob_ode_world *w, const ob_passport *p, const ob_state *s);
// Where a kinematic object is before the next step, and how it moves.
void ob_ode_world_drive(ob_ode_world *w, uint32_t id, const ob_state *s);
// The constant force (N) and torque (N m) of an object, which wakes if they are others than before.
void ob_ode_world_push(ob_ode_world *w, uint32_t id, ob_vec3 force, ob_vec3 torque);
// Gives an object that moves an impulse (N s) at its centre, and one of rotation (N m s). It wakes.
void ob_ode_world_kick(ob_ode_world *w, uint32_t id, ob_vec3 impulse, ob_vec3 twist);
// What it touches wakes. Nothing happens if there is no such object.
void ob_ode_world_remove(ob_ode_world *w, uint32_t id);
// Collides and steps by h (s). A pair of which neither moves nor is awake is not collided.
// false: there are more pairs than fit, or ODE gave up; the world may only be destroyed then.
bool ob_ode_world_step(ob_ode_world *w, double h);
// After a step that failed, the object to blame. full: it has most contacts, and there are more than fit; else it moves
// most wildly, and ODE gave up.
uint32_t ob_ode_world_culprit(const ob_ode_world *w, bool *full);
// touching: had a contact when it was last awake.
void ob_ode_world_get(const ob_ode_world *w, uint32_t id, ob_state *s, bool *asleep, bool *touching);
// Pairs of boxes that the space has found to overlap, of which at least one moves, in all steps.
uint64_t ob_ode_world_box_tests(const ob_ode_world *w);
// Contact points of the last step, sorted by (a, b); depth[i] (m) of each; returns how many there are (may exceed max).
size_t ob_ode_world_contacts(const ob_ode_world *w, ob_contact_point *out, double *depth, size_t max);

#endif
