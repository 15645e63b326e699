// obsim's own object simulators, in the caller's thread: a universe with one worker; host and worker alternate.
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "engine/engines.h"
#include "step/publish.h"
#include "step/sim.h"
#include "table/table.h"

struct ob_engine {
	ob_universe *u;
	ob_sim *sim;
	uint32_t objects;
	bool driven; // some are kinematic
};

// Runs the worker until the gate pauses.
static void work(const ob_engine *p)
{
	ob_sim_resume(p->u);
	while (!ob_gate_host_wait(p->u, 0))
		ob_step(p->sim);
}

static bool sound(const ob_engine *p, ob_error *e)
{
	const char *failure = ob_sim_failure(p->u);
	return !failure || ob_fail(e, "%s", failure);
}

// Unlinks the universe's name at once: it is private, and vanishes with the process however that ends.
static ob_universe *open_universe(const ob_world *w, const ob_run_settings *run, ob_error *e)
{
	static unsigned made;
	char name[OB_NAME_MAX];
	snprintf(name, sizeof name, "engine-%d-%u", (int)getpid(), made++);
	ob_universe_setup setup = { .name = name,
				    .capacity = w->objects,
				    .workers = 1,
				    .hulls = w->hulls,
				    .terrains = w->terrains,
				    .joints = w->joints,
				    .isolation = "thread",
				    .run = *run };
	ob_universe *u = ob_universe_create(&setup, e);
	if (u)
		ob_universe_unlink(u);
	return u;
}

// Prescribes the motion of kinematic bodies. w: from the engine's creation; NULL afterwards
static void prescribe(ob_engine *p, const ob_world *w)
{
	for (uint32_t i = 0; i < p->objects && p->driven; i++)
		if (ob_passport_of(p->u, i)->flags & OB_OBJECT_KINEMATIC)
			ob_sim_prescribe(p->u, i, w ? ob_world_path(w, i) : NULL, 0);
}

static void destroy(ob_engine *p)
{
	if (!p)
		return;
	if (p->sim)
		ob_sim_destroy(p->sim);
	ob_universe_destroy(p->u, false);
	free(p);
	ob_engine_ode_leave();
}

// The first turn, without a step, runs the broad phase of all objects: it belongs to the setup.
static ob_engine *create(const ob_world *w, const ob_run_settings *run, ob_error *e)
{
	ob_engine *p = calloc(1, sizeof *p);
	if (!p) {
		ob_fail(e, "no memory for an engine");
		return NULL;
	}
	ob_engine_ode_enter();
	p->objects = w->objects;
	p->u = open_universe(w, run, e);
	bool fine = p->u;
	for (uint32_t i = 0; i < w->hulls && fine; i++)
		fine = ob_write_hull(p->u, i, &w->hull[i]) || ob_fail(e, "no memory for hull %u", i);
	if (fine) {
		for (uint32_t i = 0; i < w->objects; i++) {
			p->driven |= (w->passport[i].flags & OB_OBJECT_KINEMATIC) != 0;
			ob_write_passport(p->u, i, &w->passport[i]);
		}
		ob_joints_write(p->u, w->joint, w->joints);
		for (uint32_t i = 0; i < w->objects; i++)
			ob_sim_place(p->u, i, &w->state[i]);
		prescribe(p, w);
		p->sim = ob_sim_create(p->u, 0, e);
	}
	if (p->sim) {
		work(p);
		if (sound(p, e))
			return p;
	}
	destroy(p);
	return NULL;
}

static bool step(ob_engine *p, ob_error *e)
{
	prescribe(p, NULL);
	ob_gate_set_pause_step(p->u, ob_step_count(p->u) + 1);
	work(p);
	return sound(p, e);
}

static void get(const ob_engine *p, ob_state *state)
{
	for (uint32_t i = 0; i < p->objects; i++)
		state[i] = ob_state_now(p->u, i, ob_newest_motion(p->u, i), ob_step_count(p->u));
}

static double recovered(const ob_engine *p)
{
	ob_counters sum;
	ob_universe_count(p->u, &sum);
	return sum.recovered;
}

// With a tolerance each island chooses its substeps, at least as many as in the settings.
static bool resolve(const ob_world *w, const ob_run_settings *s, ob_run_settings *run, ob_error *e)
{
	bool chosen = s->substeps == 0;
	if (!(s->step_length > 0))
		return ob_fail(e, "a step of %g s: it must be above 0", s->step_length);
	if (chosen && !(s->tolerance > 0))
		return ob_fail(e, "neither substeps nor a tolerance that they could be chosen from");
	*run = *s;
	run->gravity = w->gravity;
	run->substeps = chosen ? ob_run_settings_least_substeps(s->tolerance) : s->substeps;
	if (run->tolerance > 0 && run->substeps > OB_MAX_SUBSTEPS)
		return ob_fail(e, "%u substeps: a tolerance chooses %d at most", run->substeps, OB_MAX_SUBSTEPS);
	return run->iterations > 0 || ob_fail(e, "no iteration of the contact solver: at least one is needed");
}

static ob_engine *create_as(const ob_world *w, const ob_run_settings *s, ob_solver_kind solver,
			    ob_integrator integrator, ob_error *e)
{
	ob_run_settings run;
	if (!resolve(w, s, &run, e))
		return NULL;
	run.solver = solver;
	run.integrator = integrator;
	run.lag = solver == OB_SOLVER_LAGGED ? s->lag : 0;
	return create(w, &run, e);
}

static ob_engine *create_coloured(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_as(w, s, OB_SOLVER_COLOURED, OB_INTEGRATOR_EXACT, e);
}

static ob_engine *create_jacobi(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_as(w, s, OB_SOLVER_JACOBI, OB_INTEGRATOR_EXACT, e);
}

static ob_engine *create_ode(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_as(w, s, OB_SOLVER_COLOURED, OB_INTEGRATOR_ODE, e);
}

static ob_engine *create_ghost(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_as(w, s, OB_SOLVER_GHOST, OB_INTEGRATOR_EXACT, e);
}

static ob_engine *create_lagged(const ob_world *w, const ob_run_settings *s, ob_error *e)
{
	return create_as(w, s, OB_SOLVER_LAGGED, OB_INTEGRATOR_EXACT, e);
}

static bool takes_joints(const ob_world *w, ob_error *e)
{
	(void)w;
	(void)e;
	return true;
}

// clang-format off
#define USUAL .step_length = OB_DEFAULT_STEP, .substeps = OB_DEFAULT_SUBSTEPS, .iterations = OB_DEFAULT_ITERATIONS
#define THE_REST \
	.version = "", .iteration_choice = { 1, 2, 4, 8, 16, 32, 64 }, .step = step, .get = get, \
	.recovered = recovered, .destroy = destroy, .drives = OB_WORLD_DRIVES_SURFACES, .hulls = true

const ob_engine_kind ob_engine_obsim = {
	.name = "obsim", .title = "obsim (coloured)", .create = create_coloured, .usual = { USUAL, .tolerance = OB_DEFAULT_TOLERANCE }, .takes_joints = takes_joints, THE_REST
};
const ob_engine_kind ob_engine_obsim_jacobi = {
	.name = "obsim-jacobi", .title = "obsim (Jacobi)", .create = create_jacobi, .usual = { USUAL }, THE_REST
};
const ob_engine_kind ob_engine_obsim_ode = {
	.name = "obsim-ode", .title = "obsim (ODE's stepper)", .create = create_ode, .usual = { USUAL }, THE_REST
};
const ob_engine_kind ob_engine_obsim_ghost = {
	.name = "obsim-ghost", .title = "obsim (ghosts)", .create = create_ghost, .usual = { USUAL }, THE_REST
};
const ob_engine_kind ob_engine_obsim_lag = {
	.name = "obsim-lag", .title = "obsim (late neighbours)", .create = create_lagged, .usual = { USUAL, .lag = 1 }, THE_REST
};
