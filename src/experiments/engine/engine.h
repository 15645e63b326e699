// Physics engines behind one interface, so that the lab treats all of them alike: obsim itself, ODE's single world,
// Bullet. Independent of cases and errors. Each is given a world; pair friction is sqrt(mu_a mu_b), restitution
// max(e_a, e_b) in all.
//
// An engine steps in the caller's thread, frame by frame. To measure cost, read the thread's CPU clock around
// ob_engine_step, and add what it says of its own threads. Thread-safety: one thread per process at a time (ODE shuffles rows by a seed of the whole process).
#ifndef OB_ENGINE_ENGINE_H
#define OB_ENGINE_ENGINE_H

#include "settings/settings.h"
#include "engine/world.h"

typedef struct ob_engine ob_engine;

typedef struct ob_engine_kind {
	const char *name; // as on the command line: "obsim", "ode-quick"
	const char *title; // as in a legend: "obsim (coloured)"
	const char *version; // of the library; "" for obsim's own
	// Settings usual among its users at 60 Hz. A step is a frame, substeps and iterations are the engine's own;
	// gravity is the world's. obsim alone: substeps 0 = chosen from the tolerance alone; the solver and integrator
	// are the kind's.
	ob_run_settings usual;
	uint32_t iteration_choice[8]; // worth sweeping, ascending; 0 ends
	ob_engine *(*create)(const ob_world *w, const ob_run_settings *s, ob_error *e); // returns NULL and e on failure
	bool (*step)(ob_engine *p, ob_error *e); // one frame; false and e: it cannot continue
	void (*get)(const ob_engine *p, ob_state *state); // [objects], at the end of the last frame
	// J since the start: potential energy added by pushing penetrations apart. NULL = not provided
	double (*recovered)(const ob_engine *p);
	double (*cpu)(const ob_engine *p); // s, of its own threads and processes so far; NULL = it has none
	void (*destroy)(ob_engine *p); // NULL is allowed
	bool (*check)(ob_error *e); // true if its library can be loaded; NULL = it is part of the program
	ob_world_drive drives; // most general motion that it supports
	bool hulls; // supports convex hulls
	// False and e, with the name of the first joint that it has not; NULL: it has no joints.
	bool (*takes_joints)(const ob_world *w, ob_error *e);
	bool free; // simulators at times of their own: no two runs end in the same bits
} ob_engine_kind;

// All engines built in, in the order of legends; ends with NULL.
extern const ob_engine_kind *const ob_engine_kinds[];
const ob_engine_kind *ob_engine_find(const char *name); // NULL: unknown name

// ODE's QuickStep with another broad phase: it differs in cost alone, so it is not in the list.
extern const ob_engine_kind ob_engine_ode_hash;

#endif
