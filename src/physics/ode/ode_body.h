// ODE world, body and geom of one object. With ode_world.h the only code that includes <ode/ode.h>. Thread-safety: one
// thread at a time per handle; different handles may be used at once.
#ifndef OB_ODE_BODY_H
#define OB_ODE_BODY_H

#include <ode/ode.h>

#include <ob/motion.h>

// Initialises ODE; call before all other functions, once per process (after fork in a child). Idempotent, thread-safe.
void ob_ode_init(void);
// Call once in each thread that uses ODE, and when it ends.
void ob_ode_thread_init(void);
void ob_ode_thread_finish(void);

// Shared resources of stepping: working memory and a list of jobs. One for each thread that steps bodies; all of its
// worlds share it, and it is destroyed after them. NULL: out of memory.
typedef struct ob_ode_stepper ob_ode_stepper;
ob_ode_stepper *ob_ode_stepper_create(void);
void ob_ode_stepper_destroy(ob_ode_stepper *s);

// Runs step(context), in which ODE may give up: its assertions call functions that must not return. Returns false if it
// has given up. The step's working memory is then in no state to be freed; its owner, which starts with a pointer,
// abandons itself and stays reachable through it. The thread's own; not to be nested.
bool ob_ode_try(void (*step)(void *context), void *context);
_Noreturn void ob_ode_give_up(void); // from within step
void ob_ode_abandon(void **thing);

typedef struct ob_ode_body ob_ode_body;
// World, body, geom: about 1.7 kB. Static objects get no world.
ob_ode_body *ob_ode_body_create(const ob_passport *p, ob_vec3 gravity, ob_ode_stepper *s);
void ob_ode_body_destroy(ob_ode_body *b); // NULL is allowed
// True if the body of this passport would be the same.
bool ob_ode_body_serves(const ob_ode_body *b, const ob_passport *p);
// Writes the state back to the body (the closed form is authoritative, ODE's body follows it).
void ob_ode_body_set(ob_ode_body *b, const ob_state *s);
// Advances a state by ODE's own dWorldStep over h (s), under gravity, the impulse j (N s) and the angular impulse l (N
// m s, world frame, about the centre). Both impulses are spread evenly over h. Returns false if ODE gave up; the state
// is then unchanged.
bool ob_ode_body_step(ob_ode_body *b, ob_state *s, ob_vec3 j, ob_vec3 l, double h);

// ---- ode geom

// ODE geometries of our shapes. Internal to the module.

// Creates a geometry. space may be 0; returns NULL for a shape that is none of ODE's.
dGeomID ob_ode_geom_create(dSpaceID space, ob_shape shape, ob_vec3 size);
// Places a geometry without a body (static objects, single tests).
void ob_ode_geom_place(dGeomID g, ob_pose pose);

#endif
