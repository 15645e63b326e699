// Engines listed in parts.c. Each file that makes them has its own struct ob_engine. Internal to the module.
#ifndef OB_ENGINE_ENGINES_H
#define OB_ENGINE_ENGINES_H

#include <math.h>

#include "base/part.h"
#include "engine/engine.h"

extern const ob_engine_kind ob_engine_obsim; // obsim.c: one engine for each contact solver, and one with ODE's stepper
extern const ob_engine_kind ob_engine_obsim_jacobi;
extern const ob_engine_kind ob_engine_obsim_ode;
extern const ob_engine_kind ob_engine_obsim_ghost;
extern const ob_engine_kind ob_engine_obsim_lag;
extern const ob_engine_kind ob_engine_free_own; // free.c: own responses by each isolation, and two other kinds
extern const ob_engine_kind ob_engine_free_own_processes;
extern const ob_engine_kind ob_engine_free_heavy;
extern const ob_engine_kind ob_engine_free_ode;
extern const ob_engine_kind ob_engine_ode_quick; // ode.c
extern const ob_engine_kind ob_engine_ode_world;
extern const ob_engine_kind ob_engine_ode_advised;
extern const ob_engine_kind ob_engine_bullet; // parts.c
extern const ob_engine_kind ob_engine_mujoco;
extern const ob_engine_kind ob_engine_mujoco_rk4;

// False and e: the joint may break, as no other engine's does here.
static inline bool ob_engine_joint_lasts(const ob_joint_passport *j, ob_error *e)
{
	return (isinf(j->breaks_force) && isinf(j->breaks_torque)) || ob_fail(e, "joints do not break: %s", j->name);
}

// ODE's data of a thread lives as long as any engine of that thread needs it.
void ob_engine_ode_enter(void);
void ob_engine_ode_leave(void);

// ---- part

// A part of obsim that calls another engine's library (base/part.h): obsim-bullet.so, obsim-mujoco.so. The functions are
// those of ob_engine_kind; parts.c describes the engines to the program.

typedef struct ob_engine_part {
	ob_part_head head;
	// variant: 0: the usual one
	ob_engine *(*create)(const ob_world *w, const ob_run_settings *s, uint32_t variant, ob_error *e);
	bool (*step)(ob_engine *p, ob_error *e);
	void (*get)(const ob_engine *p, ob_state *state);
	void (*destroy)(ob_engine *p);
} ob_engine_part;

#endif
