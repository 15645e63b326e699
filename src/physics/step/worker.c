#include <stdlib.h>

#include "base/clock.h"
#include "baseline/ode_baseline.h"
#include "exchange/commit.h"
#include "solver/estimate.h"
#include "solver/probe.h"
#include "step/broadphase.h"
#include "step/budget.h"
#include "step/flight.h"
#include "step/islands.h"
#include "step/sim.h"
#include "step/state.h"

// ---- ode flight

// Free flight by ODE's stepper, which computes no impacts ahead: an experiment.

static ob_state state_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_motion *before = ob_newest_motion(s->u, id);
	double h = run->step_length / run->substeps;
	ob_state now = { { before->p, before->q }, before->v, before->w };
	ob_vec3 force = ob_scale(ob_passport_of(s->u, id)->force, h);
	bool done = true;
	enum { WORK_OF_SUBSTEP = 32 };
	for (uint32_t i = 0; i < run->substeps && done && !ob_budget_spent(&s->solver); i++) {
		ob_budget_note(&s->solver, WORK_OF_SUBSTEP);
		done = ob_ode_body_step(
			ob_ode_bodies_get(&s->solver.ode_bodies, run->gravity, id, ob_passport_of(s->u, id)), &now,
			force, ob_v3(0, 0, 0), h);
	}
	if (!done)
		ob_step_fail(s->u, OB_STEP_ENGINE, id);
	return now;
}

static void step_by_ode(ob_sim *s, uint32_t id)
{
	const ob_run_settings *run = s->settings;
	const ob_passport *body = ob_passport_of(s->u, id);
	const ob_motion *before = ob_newest_motion(s->u, id);
	uint64_t step = ob_step_count(s->u) + 1;
	ob_state end = state_by_ode(s, id);
	ob_motion m = { .t0 = (double)step * run->step_length,
			.valid_until = (double)(step + 1) * run->step_length,
			.p = end.pose.p,
			.q = end.pose.q,
			.v = end.v,
			.w = end.w,
			.a = ob_external_acceleration(run, body),
			.path = before->path + ob_step_reach(run, body, before->q, before->v, before->w),
			.step = (uint32_t)step,
			.flags = OB_MOTION_FREE,
			.island = id };
	ob_body_publish(s, id, &m, &end);
}

// Does what ob_ballistic_advance does (flight.h), by one step for each object. done: true for all.
static void ode_flight_advance(ob_sim *s, const uint32_t *id, uint32_t n, bool *done)
{
	for (uint32_t k = 0; k < n; k++) {
		ob_budget_begin_share(s, id[k]);
		step_by_ode(s, id[k]);
		done[k] = true;
	}
}

// ---- worker

// Number of ODE bodies that a worker keeps. All workers together keep no more than there are objects, or a few for each:
// a worker that claims islands comes to solve every object in the course of a run.
static uint32_t ode_bodies_of(const ob_universe *u)
{
	enum { LEAST = 256 }; // enough for the members of an island; .35 MB
	const uint32_t objects = ob_universe_capacity(u), workers = ob_universe_workers(u);
	const uint32_t share = objects / workers + (objects % workers != 0);
	return share < LEAST ? (objects < LEAST ? objects : LEAST) : share;
}

ob_sim *ob_sim_create(ob_universe *u, uint32_t worker, ob_error *e)
{
	uint32_t capacity = ob_universe_capacity(u);
	const ob_run_settings *run = ob_universe_settings(u);
	ob_sim *s = calloc(1, sizeof *s);
	if (s) {
		s->u = u;
		s->data = ob_universe_step_data(u);
		s->settings = run;
		s->worker = worker;
		s->solver.counters = *ob_worker_counters(u, worker); // another worker may have run its objects before
		s->times.timed = s->solver.timed = run->timed;
		s->span.traced = ob_universe_traced(u);
	}
	const ob_island_calls calls = ob_island_calls_of(s);
	if (!s || !ob_solver_create(&s->solver, run, &calls, ode_bodies_of(u)) || !ob_estimate_create(&s->solver) ||
	    !ob_island_scratch_create(s) || !ob_rotation_cache_create(&s->rotations, capacity) ||
	    (run->verify && !(s->verifier = ob_probe_create(run, OB_VERIFY_SUBSTEPS))) ||
	    (run->monolith && !(s->baseline = ob_ode_baseline_create(u)))) {
		ob_sim_destroy(s);
		ob_fail(e, "worker %u: no memory for %u objects", worker, capacity);
		return NULL;
	}
	s->fly = s->solver.methods.exact ? ob_ballistic_advance : ode_flight_advance;
	if (run->one_per_object && worker < capacity && ob_passport_of(u, worker)->flags & OB_OBJECT_PRESENT) {
		ob_ode_bodies_get(&s->solver.ode_bodies, run->gravity, worker, ob_passport_of(u, worker)); // its own
	}
	if (ob_universe_contains(u) && worker == ob_universe_simulators(u)) {
		if (ob_cluster_create(u, &s->cluster))
			s->committer = ob_committer_create(u, s->cluster);
		if (!s->committer) {
			ob_sim_destroy(s);
			ob_fail(e, "arranger: no memory for %u objects", capacity);
			return NULL;
		}
	}
	if (s->times.timed) { // it waits at the gate from now on; the previous worker's wait ended with it
		s->solver.counters.since_ns = ob_clock_ns();
		s->times.cpu_end = ob_clock_thread_cpu();
		*ob_worker_counters(u, worker) = s->solver.counters;
	}
	return s;
}

void ob_sim_destroy(ob_sim *s)
{
	if (!s)
		return;
	ob_ode_baseline_destroy(s->baseline);
	ob_estimate_finish(&s->solver);
	ob_solver_finish(&s->solver);
	ob_island_scratch_finish(s);
	ob_probe_destroy(s->verifier);
	ob_rotation_cache_finish(&s->rotations);
	ob_committer_destroy(s->committer);
	ob_cluster_destroy(s->cluster);
	free(s);
}

void ob_sim_set_scripts(ob_sim *s, ob_script_run run, void *runner)
{
	s->scripts.run = run;
	s->scripts.runner = runner;
}

bool ob_sim_join(ob_sim *s, const ob_peers *p, ob_error *e)
{
	s->cluster->peers = *p;
	return ob_peers_join(&s->cluster->peers, s->u, e);
}

void ob_sim_leave(ob_sim *s)
{
	if (s->cluster)
		ob_peers_leave(&s->cluster->peers);
}

void ob_sim_run(ob_sim *s)
{
	while (ob_step(s))
		;
}
