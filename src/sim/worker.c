#include <stdlib.h>

#include "sim/broadphase.h"
#include "sim/fetch.h"
#include "sim/island.h"
#include "sim/late_contacts.h"
#include "sim/ode_baseline.h"
#include "sim/profile.h"
#include "sim/publish.h"
#include "sim/sim.h"
#include "sim/state.h"
#include "sim/step.h"

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
		s->counters = *ob_worker_counters(u, worker); // another may have run them before
		s->times.timed = s->times.wanted = run->timed;
		s->span.traced = ob_universe_traced(u);
		s->island.row_of = calloc(capacity, sizeof *s->island.row_of);
	}
	if (!s || !s->island.row_of || !ob_ode_bodies_create(&s->worlds, u) || !ob_rotation_cache_create(&s->plans, capacity)) {
		ob_sim_destroy(s);
		ob_fail(e, "worker %u: no memory for %u objects", worker, capacity);
		return NULL;
	}
	if (run->monolith) {
		s->monolith = ob_ode_baseline_create(u);
	} else if (run->one_per_object && ob_passport_of(u, worker)->flags & OB_OBJECT_PRESENT) {
		ob_ode_bodies_get(&s->worlds, u, worker); // its own object
	}
	if (s->times.timed) { // it waits at the gate from now on; another's waiting ended with it
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
	ob_ode_bodies_finish(&s->worlds);
	ob_ode_baseline_destroy(s->monolith);
	ob_island_work_finish(&s->island);
	ob_rotation_cache_finish(&s->plans);
	free(s);
}

static void solve(ob_sim *s, uint32_t island, bool first)
{
	bool shown = ob_span_island_begin(s, island, first);
	ob_island_solve(s, island);
	if (shown)
		ob_span_island_end(s, island);
}

static uint32_t solve_chunk(ob_sim *s, uint32_t chunk)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	uint32_t objects = 0;
	ob_span_chunk_begin(s);
	for (uint32_t i = ex->chunk[chunk]; i < ex->chunk[chunk + 1]; i++) {
		if (i + 1 < ex->chunk[chunk + 1]) // beyond it another worker writes what would be read here
			ob_prefetch_island(s, i + 1);
		solve(s, i, i == ex->chunk[chunk]);
		objects += ex->island[i].members;
	}
	ob_span_chunk_end(s, chunk);
	return objects;
}

// The worker's share of the islands: those that it claims, or the one that its object leads.
static void work_islands(ob_sim *s)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	uint32_t chunk, objects = 0;
	if (ob_universe_settings(s->u)->one_per_object) {
		solve(s, ex->result_island[s->worker], true);
		return;
	}
	while (ob_task_claim(s->u, &chunk))
		objects += solve_chunk(s, chunk);
	ob_worker_set_objects(s->u, s->worker, objects);
}

// An object looks around if it asked to, or it copies its own state from where its island's leader has left it.
static void work_own_member(ob_sim *s)
{
	uint32_t id = s->worker;
	if (ob_universe_step_data(s->u)->count->stage == OB_STAGE_COPY)
		ob_result_copy(s, id);
	else
		ob_broadphase_query(s->u, id, &s->counters.box_tests);
}

static void work_members(ob_sim *s)
{
	uint32_t count, i;
	const uint32_t *list = ob_requery_list(s->u, &count);
	if (ob_universe_settings(s->u)->one_per_object) {
		work_own_member(s);
		return;
	}
	while (ob_task_claim(s->u, &i))
		ob_broadphase_query(s->u, list[i], &s->counters.box_tests);
}

static void work_meetings(ob_sim *s)
{
	const ob_step_data *ex = ob_universe_step_data(s->u);
	bool solved = ex->count->stage == OB_STAGE_SOLVED;
	uint32_t i;
	while (ob_task_claim(s->u, &i)) {
		uint32_t first = i * OB_LATE_CONTACTS_BATCH, end = first + OB_LATE_CONTACTS_BATCH;
		ob_late_contacts_check(s, first, end < ex->count->pairs ? end : ex->count->pairs, solved);
	}
}

void ob_sim_work(ob_sim *s, ob_phase phase)
{
	ob_profile_begin(s, phase == OB_PHASE_ISLANDS ? OB_PROFILE_LOAD : OB_PROFILE_BROADPHASE);
	if (s->monolith) {
		ob_profile_enter(s, OB_PROFILE_SOLVE);
		ob_ode_baseline_step(s->monolith);
		s->counters.box_tests = ob_ode_baseline_box_tests(s->monolith);
	} else if (phase == OB_PHASE_ISLANDS)
		work_islands(s);
	else if (phase == OB_PHASE_OBJECTS)
		work_members(s);
	else if (phase == OB_PHASE_LATE_CONTACTS)
		work_meetings(s);
	ob_phase_worked(s->u, ob_profile_end(s));
	*ob_worker_counters(s->u, s->worker) = s->counters;
}

void ob_sim_schedule(ob_sim *s, ob_phase finished)
{
	ob_profile_begin(s, OB_PROFILE_SCHEDULE);
	ob_schedule_next_phase(s, finished);
	ob_critical_add(s->u, ob_profile_end(s));
}

void ob_sim_run(ob_sim *s)
{
	for (;;) {
		ob_span_turn(s, OB_TRACE_WAIT);
		ob_phase phase = ob_gate_wait(s->u, s->worker);
		if (phase == OB_PHASE_STOP)
			break;
		ob_span_turn(s, phase == OB_PHASE_ISLANDS ? OB_TRACE_SOLVE : OB_TRACE_OBJECTS);
		ob_sim_work(s, phase);
		if (ob_gate_arrive(s->u, s->worker)) {
			ob_span_turn(s, OB_TRACE_SCHEDULE);
			ob_sim_schedule(s, phase);
		}
	}
	ob_span_turn(s, OB_TRACE_NONE);
}
