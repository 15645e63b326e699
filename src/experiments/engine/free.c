// Free simulators (free/free.h), led by a host as in `obsim run --sync free`: two workers, threads or processes. A substep is
// a simulator's step, so substeps give the rate; the lag of the settings is the delay of publications, in ms.
//
// The workers' CPU is their own, so the engine tells it apart from the caller's.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "engine/engines.h"
#include "host/host.h"

static const double jitter = .3, steps_of_lag = 2, millisecond = 1e-3;

struct ob_engine {
	ob_scene scene;
	ob_host *host;
	uint64_t steps;
};

typedef struct form {
	ob_isolation isolation;
	ob_integrator integrator;
	bool heavy;
} form;

static void destroy(ob_engine *p)
{
	if (!p)
		return;
	ob_host_stop(p->host);
	free(p->scene.object);
	free(p);
}

static bool describe(ob_scene *s, const ob_world *w)
{
	*s = (ob_scene){ .run = { .gravity = w->gravity },
			 .objects = w->objects,
			 .object = calloc(w->objects + 1, sizeof *s->object),
			 .hulls = w->hulls,
			 .hull = w->hull };
	for (uint32_t i = 0; s->object && i < w->objects; i++)
		s->object[i] = (ob_object_def){ .passport = w->passport[i], .state = w->state[i], .dies = INFINITY };
	return s->object;
}

static ob_engine *create(const ob_world *w, const ob_run_settings *s, form as, ob_error *e)
{
	if (!(s->step_length > 0) || s->substeps == 0 || s->iterations == 0) {
		ob_fail(e, "free simulators need a step, substeps and iterations");
		return NULL;
	}
	ob_engine *p = calloc(1, sizeof *p);
	const double rate = s->substeps / s->step_length;
	static unsigned made;
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "engine-%d-%u", (int)getpid(), made++);
	const ob_free_settings free = { .update_rate = rate,
					.rate_most = rate,
					.max_lag = steps_of_lag / rate,
					.jitter = jitter,
					.delay = s->lag * millisecond,
					.pace = INFINITY,
					.end = INFINITY,
					.seed = 1,
					.coupling = OB_COUPLING_OWN,
					.heavy = as.heavy };
	ob_host_config c = { .name = name, .isolation = as.isolation, .workers = 2, .run = *s, .free = &free };
	c.run.gravity = w->gravity;
	c.run.substeps = 1;
	c.run.tolerance = 0;
	c.run.lag = 0;
	c.run.sleeping = 0;
	c.run.integrator = as.integrator;
	if (!p || !describe(&p->scene, w)) {
		ob_fail(e, "no memory for an engine");
		destroy(p);
		return NULL;
	}
	p->host = ob_host_start(&p->scene, &c, e);
	if (p->host)
		ob_host_go(p->host, 0);
	if (p->host && ob_host_wait(p->host, e))
		return p;
	destroy(p);
	return NULL;
}

static bool step(ob_engine *p, ob_error *e)
{
	ob_host_go(p->host, ++p->steps);
	return ob_host_wait(p->host, e);
}

static void get(const ob_engine *p, ob_state *state)
{
	const ob_universe *u = ob_host_universe(p->host);
	for (uint32_t i = 0; i < p->scene.objects; i++) {
		ob_motion m;
		ob_universe_get_motion(u, i, &m);
		state[i] = ob_motion_at(&m, p->scene.object[i].passport.inertia, m.t0);
	}
}

static double cpu(const ob_engine *p)
{
	ob_host_times t;
	ob_host_get_times(p->host, &t);
	return t.cpu_s;
}

static ob_engine *create_own(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, (form){ .heavy = false }, e);
}

static ob_engine *create_own_processes(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, (form){ .isolation = OB_ISOLATION_PROCESS }, e);
}

static ob_engine *create_heavy(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, (form){ .heavy = true }, e);
}

static ob_engine *create_ode(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create(w, s, (form){ .integrator = OB_INTEGRATOR_ODE }, e);
}

// clang-format off
#define THE_REST \
	.version = "", .free = true, .iteration_choice = { 16 }, .step = step, .get = get, .cpu = cpu, .destroy = destroy, .hulls = true, \
	.usual = { .step_length = OB_DEFAULT_STEP, .substeps = 16, .iterations = OB_DEFAULT_ITERATIONS }

const ob_engine_kind ob_engine_free_own = {
	.name = "free-own", .title = "free, own", .create = create_own, THE_REST
};
const ob_engine_kind ob_engine_free_own_processes = {
	.name = "free-own-processes", .title = "free, own, processes", .create = create_own_processes, THE_REST
};
const ob_engine_kind ob_engine_free_heavy = {
	.name = "free-own-heavy", .title = "free, own, heavy neighbours", .create = create_heavy, THE_REST
};
const ob_engine_kind ob_engine_free_ode = {
	.name = "free-own-ode", .title = "free, own, ODE's stepper", .create = create_ode, THE_REST
};
