// ODE as most of its users have it: one world that holds everything (ode/ode_world.h).
#include <stdlib.h>

#include "ode/ode_world.h"
#include "engine/engines.h"

struct ob_engine {
	ob_ode_world *world;
	double substep; // s
	uint32_t substeps, objects;
};

static void destroy(ob_engine *p)
{
	if (!p)
		return;
	ob_ode_world_destroy(p->world);
	free(p);
	ob_engine_ode_leave();
}

// iterations: QuickStep's; 0 = dWorldStep
static ob_engine *create(const ob_world *w, const ob_run_settings *s, uint32_t iterations, bool hashed, ob_error *e)
{
	if (!(s->step_length > 0) || !s->substeps) {
		ob_fail(e, "%u substeps of a step of %g s: ODE must be told what to do", s->substeps, s->step_length);
		return NULL;
	}
	ob_engine *p = calloc(1, sizeof *p);
	if (!p) {
		ob_fail(e, "no memory for an engine");
		return NULL;
	}
	ob_engine_ode_enter();
	*p = (ob_engine){ .substep = s->step_length / s->substeps, .substeps = s->substeps, .objects = w->objects };
	p->world = ob_ode_world_create(&(ob_ode_world_setup){
		.gravity = w->gravity,
		.iterations = iterations,
		.objects = w->objects,
		.sleeping = s->sleeping,
		.hashed = hashed,
	});
	if (!p->world) {
		ob_fail(e, "no memory for a world of %u bodies", w->objects);
		destroy(p);
		return NULL;
	}
	for (uint32_t i = 0; i < w->objects; i++)
		ob_ode_world_add(p->world, &w->passport[i], &w->state[i]);
	return p;
}

static ob_engine *create_iterating(const ob_world *w, const ob_run_settings *s, bool hashed, ob_error *e)
{
	if (s->iterations)
		return create(w, s, s->iterations, hashed, e);
	ob_fail(e, "QuickStep without iterations: at least one is needed");
	return NULL;
}

static ob_engine *create_quick(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_iterating(w, s, false, e);
}

static ob_engine *create_hashed(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_iterating(w, s, true, e);
}

static ob_engine *create_world(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, 0, false, e);
}

static bool step(ob_engine *p, ob_error *e)
{
	for (uint32_t i = 0; i < p->substeps; i++)
		if (!ob_ode_world_step(p->world, p->substep))
			return ob_fail(e, "no memory for the contacts");
	return true;
}

static void get(const ob_engine *p, ob_state *state)
{
	bool asleep, touching;
	for (uint32_t i = 0; i < p->objects; i++)
		ob_ode_world_get(p->world, i, &state[i], &asleep, &touching);
}

#define THE_REST .version = OB_ODE_VERSION, .step = step, .get = get, .destroy = destroy
#define QUICK \
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1, .iterations = OB_DEFAULT_MONOLITH_ITERATIONS }, \
	.iteration_choice = { 5, 10, 20, 50, 100, 200, 500 }

const ob_engine_kind ob_engine_ode_quick = {
	.name = "ode-quick",
	.title = "ODE QuickStep",
	.create = create_quick,
	QUICK,
	THE_REST,
};

const ob_engine_kind ob_engine_ode_hash = {
	.name = "ode-hash",
	.title = "ODE QuickStep, hash space",
	.create = create_hashed,
	QUICK,
	THE_REST,
};

const ob_engine_kind ob_engine_ode_world = {
	.name = "ode-world",
	.title = "ODE dWorldStep",
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 1 },
	.create = create_world,
	THE_REST,
};
