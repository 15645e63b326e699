#include <stdlib.h>

#include "base/clock.h"
#include "sim/commit.h"
#include "sim/island_solver.h"
#include "sim/ode_baseline.h"
#include "sim/peers.h"
#include "sim/sim.h"
#include "sim/state.h"

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
		s->island.unit = ob_run_settings_units(run);
		s->island.tolerance = OB_DEFAULT_TOLERANCE * s->island.unit.length;
		s->island.run_coarseness = s->island.coarseness = ob_run_settings_coarseness(run);
		s->counters = *ob_worker_counters(u, worker); // another worker may have run its objects before
		s->times.timed = s->times.wanted = run->timed;
		s->span.traced = ob_universe_traced(u);
		s->island.row_of = calloc(capacity, sizeof *s->island.row_of);
	}
	if (!s || !s->island.row_of || !ob_ode_bodies_create(&s->ode_bodies, u) ||
	    !ob_rotation_cache_create(&s->rotations, capacity) ||
	    (run->monolith && !(s->baseline = ob_ode_baseline_create(u)))) {
		ob_sim_destroy(s);
		ob_fail(e, "worker %u: no memory for %u objects", worker, capacity);
		return NULL;
	}
	if (run->one_per_object && worker < capacity && ob_passport_of(u, worker)->flags & OB_OBJECT_PRESENT) {
		ob_ode_bodies_get(&s->ode_bodies, u, worker); // its own object
	}
	if (ob_universe_contains(u) && worker == ob_universe_simulators(u)) {
		s->committer = ob_committer_create(u);
		if (!s->committer) {
			ob_sim_destroy(s);
			ob_fail(e, "arranger: no memory for %u objects", capacity);
			return NULL;
		}
	}
	if (s->times.timed) { // it waits at the gate from now on; the previous worker's wait ended with it
		s->counters.since_ns = ob_clock_ns();
		s->times.cpu_end = ob_clock_thread_cpu();
		*ob_worker_counters(u, worker) = s->counters;
	}
	return s;
}

void ob_sim_destroy(ob_sim *s)
{
	if (!s)
		return;
	ob_ode_bodies_finish(&s->ode_bodies);
	ob_ode_baseline_destroy(s->baseline);
	ob_island_work_finish(&s->island);
	ob_rotation_cache_finish(&s->rotations);
	ob_committer_destroy(s->committer);
	free(s);
}

void ob_sim_set_scripts(ob_sim *s, ob_script_run run, void *runner)
{
	s->scripts.run = run;
	s->scripts.runner = runner;
}

bool ob_sim_join(ob_sim *s, const ob_peers *p, ob_error *e)
{
	s->peers = *p;
	return ob_peers_join(&s->peers, s->u, e);
}

void ob_sim_leave(ob_sim *s)
{
	ob_peers_leave(&s->peers);
}

void ob_sim_run(ob_sim *s)
{
	while (ob_step(s))
		;
}
