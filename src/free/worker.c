// A worker of a free run: makes the steps of its simulators, the earliest first.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "free/free.h"
#include "free/lag.h"
#include "free/view.h"
#include "step/fault.h"
#include "table/trace.h"

typedef struct worker {
	ob_universe *u;
	uint32_t worker, sims;
	uint32_t *id; // [sims] their objects
	ob_free_sim *sim;
	double *time; // [sims] their own times, side by side for the search; infinity: absent, or failed
	ob_free_scratch scratch;
	uint32_t until; // as of the last look
	uint32_t
		waits; // object whose simulator waits for a neighbour, until the worker does something else; OB_NO_OBJECT
	uint64_t fault_chances;
	ob_trace_event span; // of the trace, as it goes on; kind NONE: none
} worker;

uint32_t ob_free_worker_of(const ob_universe *u, uint32_t id)
{
	const uint32_t workers = ob_universe_workers(u), capacity = ob_universe_capacity(u);
	const uint32_t most = ob_free_settings_of(u)->objects;
	if (ob_universe_settings(u)->one_per_object || workers >= capacity)
		return id;
	return id < most ? (uint32_t)((uint64_t)id * workers / most) : id % workers;
}

// Notes the time of a simulator for the search of the earliest.
static void note_time(worker *w, const ob_free_sim *s)
{
	w->time[s - w->sim] = s->present && !s->failed ? s->time : INFINITY;
}

// Begins simulators of objects that are new to this worker. Objects come and go while all wait for the host. Chances of
// faults are counted by updates, so that a successor does not fail at the same place for ever.
static bool adopt(worker *w)
{
	uint32_t generation;
	const bool first = w->fault_chances == 0;
	for (uint32_t i = 0; i < w->sims; i++) {
		const uint32_t id = w->id[i];
		ob_free_sim *s = &w->sim[i];
		const bool present = ob_free_kind_of(w->u, id, &generation) == OB_FREE_SIMULATED;
		if ((present != s->present || (present && generation != s->generation)) &&
		    !ob_free_sim_begin(s, w->u, id))
			return false;
		note_time(w, s);
		w->fault_chances += first ? s->counts.updates : 0;
	}
	return true;
}

static bool begin(worker *w, ob_universe *u, uint32_t number)
{
	*w = (worker){ .u = u, .worker = number, .waits = OB_NO_OBJECT };
	const uint32_t capacity = ob_universe_capacity(u);
	for (uint32_t id = 0; id < capacity; id++)
		w->sims += ob_free_worker_of(u, id) == number;
	w->sim = calloc(w->sims + 1, sizeof *w->sim);
	w->id = calloc(w->sims + 1, sizeof *w->id);
	w->time = calloc(w->sims + 1, sizeof *w->time);
	for (uint32_t id = 0, n = 0; w->id && id < capacity; id++)
		if (ob_free_worker_of(u, id) == number)
			w->id[n++] = id;
	w->scratch.worker = number;
	return w->sim && w->id && w->time && ob_free_scratch_begin(&w->scratch, u);
}

static void finish(worker *w)
{
	for (uint32_t i = 0; w->sim && i < w->sims; i++)
		ob_free_sim_finish(&w->sim[i]);
	free(w->sim);
	free(w->id);
	free(w->time);
	ob_free_schedule_close(w->scratch.schedule);
	ob_free_scratch_finish(&w->scratch);
}

// Returns the earliest simulator that may step, as far as is known; NULL: none. blocked: then the earliest that a
// neighbour blocks.
static ob_free_sim *earliest(worker *w, ob_free_sim **blocked)
{
	const double until = w->until * w->scratch.boundary;
	ob_free_sim *first = NULL;
	*blocked = NULL;
	for (uint32_t i = 0; i < w->sims; i++) {
		if (w->time[i] >= until || (first && w->time[i] >= first->time))
			continue;
		ob_free_sim *s = &w->sim[i];
		if (s->blocker != OB_NO_OBJECT && !ob_free_lag_is_over(s, w->u)) {
			if (!*blocked || s->time < (*blocked)->time)
				*blocked = s;
			continue;
		}
		s->blocker = OB_NO_OBJECT;
		first = s;
	}
	return first;
}

// Ends the span of the trace that goes on, and begins another. Steps that follow each other are one span.
static void turn_to(worker *w, ob_trace_kind kind, uint32_t a, uint32_t b)
{
	const bool same = kind == w->span.kind && (kind != OB_TRACE_LAG || (a == w->span.a && b == w->span.b));
	if (!ob_universe_traced(w->u) || same)
		return;
	const uint64_t now = w->span.kind == OB_TRACE_NONE ? ob_clock_ns()
							   : ob_trace_span(w->u, w->worker, w->span.kind, w->span.begin,
									   w->span.a, w->span.b);
	w->span = (ob_trace_event){ .begin = now, .kind = kind, .a = a, .b = b };
	ob_trace_doing(w->u, w->worker, kind, now);
}

// Sleeps until a simulator is due by the clock. false: it is due.
static bool wait_for_clock(worker *w, const ob_free_sim *s)
{
	const double most = .02;
	const uint64_t due = ob_free_due_ns(w->u, s->time), now = ob_clock_ns();
	if (now >= due)
		return false;
	turn_to(w, OB_TRACE_CLOCK, 0, 0);
	const double left = ob_min(most, 1e-9 * (double)(due - now));
	nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * left) }, NULL);
	return true;
}

// Notes that a simulator waits for a neighbour, or none (OB_NO_OBJECT).
static void note_wait(worker *w, uint32_t id)
{
	if (w->waits != OB_NO_OBJECT && w->waits != id)
		ob_free_end_wait(w->u, w->waits);
	w->waits = id;
}

static void work(worker *w)
{
	ob_free_sim *blocked, *s = earliest(w, &blocked);
	note_wait(w, !s && blocked ? blocked->id : OB_NO_OBJECT);
	if (!s && blocked) {
		turn_to(w, OB_TRACE_LAG, blocked->id, blocked->blocker);
		blocked->counts.waits++;
		blocked->counts.wait_ns += ob_free_wait_for(w->u, blocked->id, blocked->blocker, blocked->needed);
		ob_free_put_counts(w->u, blocked->id, &blocked->counts);
	} else if (!s) {
		turn_to(w, OB_TRACE_WAIT, 0, 0);
		if (w->sims == 1 && w->sim->present) {
			ob_free_sim_sleep(w->sim, &w->scratch, w->until * w->scratch.boundary);
			note_time(w, w->sim);
		}
		ob_free_wait_for_host(w->u, w->until);
	} else if (!wait_for_clock(w, s) && ob_free_lag_allows(s, &w->scratch)) {
		ob_worker_set_object(w->u, w->worker, s->id);
		turn_to(w, OB_TRACE_STEPS, 0, 0);
		ob_free_sim_step(s, &w->scratch);
		note_time(w, s);
		w->span.a++;
		ob_fault_chance_of(w->u, w->worker, &w->fault_chances);
	}
}

// Waits until the host lets simulators go on. It does not if steps are missing: each waits for the other then.
static void wait_for_host(worker *w)
{
	const uint32_t looks = ob_free_looks(w->u);
	turn_to(w, OB_TRACE_WAIT, 0, 0);
	while (!ob_gate_stopped(w->u) && ob_free_until(w->u) == w->until) {
		if (ob_free_looks(w->u) - looks >= 2) {
			ob_free_schedule_refuse(w->scratch.schedule);
			return;
		}
		ob_free_wait_for_host(w->u, w->until);
	}
}

// Makes the next step of a replayed schedule, once the host has come so far.
static void replay(worker *w)
{
	ob_free_planned_step step;
	if (!ob_free_schedule_next(w->scratch.schedule, &step) || step.end > w->until * w->scratch.boundary) {
		wait_for_host(w);
		return;
	}
	turn_to(w, OB_TRACE_STEPS, 0, 0);
	ob_free_sim *s = &w->sim[step.id]; // there is one worker
	const bool begun = !step.anew || ob_free_sim_begin(s, w->u, step.id);
	if (!begun || !s->present || s->failed || !(step.end > s->time))
		ob_free_schedule_refuse(w->scratch.schedule);
	else
		ob_free_sim_step(s, &w->scratch);
	w->span.a++;
	ob_free_schedule_take(w->scratch.schedule);
}

bool ob_free_work(ob_universe *u, uint32_t number, ob_error *e)
{
	worker w;
	if (!begin(&w, u, number))
		return ob_fail(e, "worker %u: no memory", number);
	bool fine = ob_free_schedule_open(&w.scratch.schedule, u, e);
	const bool replays = ob_free_schedule_replays(w.scratch.schedule);
	while (fine && !ob_gate_stopped(u)) {
		const uint32_t until = ob_free_until(u);
		if (until != w.until) {
			w.until = until;
			ob_counters_copy(ob_worker_counters(u, number),
					 &w.scratch.solver.counters); // their host looks now and then
			fine = adopt(&w) || ob_fail(e, "no memory for worker %u", number);
		}
		if (fine && replays)
			replay(&w);
		else if (fine)
			work(&w);
		fine = fine && ob_free_schedule_is_fine(w.scratch.schedule, e);
	}
	if (!fine) {
		ob_step_misses_plan(u, e->text);
		while (!ob_gate_stopped(u))
			ob_free_wait_for_host(u, w.until);
	}
	turn_to(&w, OB_TRACE_NONE, 0, 0);
	ob_counters_copy(ob_worker_counters(u, number), &w.scratch.solver.counters);
	finish(&w);
	return true;
}
