// A worker of a free run: makes the steps of its simulators, the earliest first.
//
//   heap       simulators by own time; one in flight, by the end of its flight; absent, failed and blocked ones last
//   blocked    by the bound of the lag, looked at in turn; if all that is due is blocked, the worker waits for a neighbour
//   lowered    flights marked by others, looked at when the worker's word has moved (table/free.h)
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "free/free.h"
#include "free/group_worker.h"
#include "free/lag.h"
#include "free/view.h"
#include "step/fault.h"
#include "table/group.h"
#include "table/trace.h"

typedef struct worker {
	ob_universe *u;
	uint32_t worker, sims;
	ob_free_sim *sim; // [sims] ascending by their objects
	double *time; // [sims] keys of the heap
	uint32_t *heap, *place; // [sims] simulators, the earliest first; its place there
	uint32_t *blocked, blocked_n; // simulators that a neighbour blocks
	uint32_t turn; // index of the blocked one to look at next
	uint64_t *mine; // [groups of objects] bits of those that are this worker's
	ob_free_scratch scratch;
	uint32_t until, entered, word; // as of the last look
	uint32_t
		waits; // object whose simulator waits for a neighbour, until the worker does something else; OB_NO_OBJECT
	uint64_t fault_chances;
	ob_trace_event span; // of the trace, as it goes on; kind NONE: none
} worker;

// ---- the heap

static void put_in_heap(worker *w, uint32_t at, uint32_t sim)
{
	w->heap[at] = sim;
	w->place[sim] = at;
}

// True if simulator a comes first; at the same time, the one of the lower object.
static bool is_before(const worker *w, uint32_t a, uint32_t b)
{
	return w->time[a] < w->time[b] || (w->time[a] == w->time[b] && a < b);
}

static void set_key(worker *w, uint32_t sim, double time)
{
	uint32_t at = w->place[sim], child;
	w->time[sim] = time;
	for (; at > 0 && is_before(w, sim, w->heap[(at - 1) / 2]); at = (at - 1) / 2)
		put_in_heap(w, at, w->heap[(at - 1) / 2]);
	for (; (child = 2 * at + 1) < w->sims; at = child) {
		child += child + 1 < w->sims && is_before(w, w->heap[child + 1], w->heap[child]);
		if (is_before(w, sim, w->heap[child]))
			break;
		put_in_heap(w, at, w->heap[child]);
	}
	put_in_heap(w, at, sim);
}

// Notes the time of a simulator for the search of the earliest.
static void note_time(worker *w, const ob_free_sim *s)
{
	set_key(w, (uint32_t)(s - w->sim), s->present && !s->failed ? s->time : INFINITY);
}

// Begins simulators of objects that are new to this worker. Objects come and go while all wait for the host. Chances of
// faults are counted by updates, so that a successor does not fail at the same place for ever.
static bool adopt(worker *w)
{
	uint32_t generation;
	const bool first = w->fault_chances == 0;
	w->blocked_n = 0;
	for (uint32_t i = 0; i < w->sims; i++) {
		ob_free_sim *s = &w->sim[i];
		const uint32_t id = s->id;
		const bool present = ob_free_kind_of(w->u, id, &generation) == OB_FREE_SIMULATED;
		if ((present != s->present || (present && generation != s->generation)) &&
		    !ob_free_sim_begin(s, w->u, id))
			return false;
		s->blocker = OB_NO_OBJECT;
		note_time(w, s);
		w->fault_chances += first ? s->counts.updates : 0;
	}
	return true;
}

static bool begin(worker *w, ob_universe *u, uint32_t number)
{
	*w = (worker){ .u = u, .worker = number, .entered = ob_free_entered(u), .waits = OB_NO_OBJECT };
	enum { FEW = 8 }; // simulators that test all boxes sooner than they keep a grid of them
	const uint32_t capacity = ob_universe_capacity(u);
	w->mine = calloc((capacity + OB_FREE_GROUP - 1) / OB_FREE_GROUP + 1, sizeof *w->mine);
	for (uint32_t id = 0; id < capacity; id++)
		w->sims += ob_free_worker_of(u, id) == number;
	w->sim = calloc(w->sims + 1, sizeof *w->sim);
	w->time = calloc(w->sims + 1, sizeof *w->time);
	w->heap = calloc(w->sims + 1, sizeof *w->heap);
	w->place = calloc(w->sims + 1, sizeof *w->place);
	w->blocked = calloc(w->sims + 1, sizeof *w->blocked);
	if (!w->sim || !w->time || !w->heap || !w->place || !w->blocked || !w->mine ||
	    !ob_free_boxes_begin(&w->scratch.boxes, u, w->sims > FEW))
		return false;
	for (uint32_t id = 0, n = 0; id < capacity; id++) {
		if (ob_free_worker_of(u, id) != number)
			continue;
		w->sim[n] = (ob_free_sim){ .id = id, .blocker = OB_NO_OBJECT };
		w->time[n] = INFINITY;
		put_in_heap(w, n, n);
		w->mine[id / OB_FREE_GROUP] |= UINT64_C(1) << id % OB_FREE_GROUP;
		n++;
	}
	w->scratch.worker = number;
	w->scratch.all = w->sim;
	w->scratch.sims = w->sims;
	return ob_free_scratch_begin(&w->scratch, u);
}

static void finish(worker *w)
{
	for (uint32_t i = 0; w->sim && i < w->sims; i++)
		ob_free_sim_finish(&w->sim[i]);
	free(w->sim);
	free(w->time);
	free(w->heap);
	free(w->place);
	free(w->blocked);
	free(w->mine);
	ob_free_schedule_close(w->scratch.schedule);
	ob_free_boxes_finish(&w->scratch.boxes);
	ob_free_scratch_finish(&w->scratch);
}

// ---- who is next

static int by_id(const void *id, const void *sim)
{
	const uint32_t a = *(const uint32_t *)id, b = ((const ob_free_sim *)sim)->id;
	return a < b ? -1 : a > b;
}

// Looks at a flight that another may have lowered.
static void look_at(worker *w, ob_free_sim *s)
{
	ob_free_sim_look(s, w->u);
	s->needed = 0;
	if (s->blocker == OB_NO_OBJECT)
		note_time(w, s);
}

// Looks at flights that others have lowered, if the worker's word has moved.
static void look_at_lowered(worker *w, uint32_t word)
{
	const uint32_t ids = word == w->word ? 0 : ob_universe_ids(w->u);
	w->word = word;
	for (uint32_t g = 0; g * OB_FREE_GROUP < ids; g++)
		for (uint64_t bits = w->mine[g] ? ob_free_take_lowered(w->u, g, w->mine[g]) : 0; bits;
		     bits &= bits - 1) {
			const uint32_t id = g * OB_FREE_GROUP + (uint32_t)__builtin_ctzll(bits);
			look_at(w, bsearch(&id, w->sim, w->sims, sizeof *w->sim, by_id));
		}
}

// Puts simulators back that nobody blocks any more: looks at some of those that are blocked, or at all of them.
static void unblock(worker *w, bool all)
{
	enum { SOME = 8 };
	for (uint32_t tries = all ? w->blocked_n : SOME; tries > 0 && w->blocked_n > 0; tries--) {
		w->turn = (w->turn + 1) % w->blocked_n;
		ob_free_sim *s = &w->sim[w->blocked[w->turn]];
		if (!ob_free_lag_is_over(s, w->u))
			continue;
		w->blocked[w->turn] = w->blocked[--w->blocked_n];
		s->blocker = OB_NO_OBJECT;
		note_time(w, s);
	}
}

// Returns the earliest simulator that no neighbour is known to block; NULL: none is due before `until`.
static ob_free_sim *earliest(worker *w)
{
	const double until = w->until * w->scratch.boundary;
	unblock(w, false);
	if (w->sims == 0 || !(w->time[w->heap[0]] < until))
		unblock(w, true);
	return w->sims > 0 && w->time[w->heap[0]] < until ? &w->sim[w->heap[0]] : NULL;
}

// Returns the earliest simulator that a neighbour blocks; NULL: there is none.
static ob_free_sim *earliest_blocked(const worker *w)
{
	ob_free_sim *first = NULL;
	for (uint32_t i = 0; i < w->blocked_n; i++) {
		ob_free_sim *s = &w->sim[w->blocked[i]];
		if (!first || s->time < first->time)
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

// Sleeps until a simulator is due by the clock, or a flight is lowered. false: it is due.
static bool wait_for_clock(worker *w, const ob_free_sim *s)
{
	const double most = .02;
	const uint64_t due = ob_free_due_ns(w->u, s->time), now = ob_clock_ns();
	if (now >= due)
		return false;
	turn_to(w, OB_TRACE_CLOCK, 0, 0);
	if (s->aloft)
		ob_free_idle(w->u, w->worker, w->word, w->until, INFINITY, due - now);
	else
		nanosleep(&(struct timespec){ .tv_nsec = (long)(1e9 * ob_min(most, 1e-9 * (double)(due - now))) },
			  NULL);
	return true;
}

// Notes that a simulator waits for a neighbour, or none (OB_NO_OBJECT).
static void note_wait(worker *w, uint32_t id)
{
	if (w->waits != OB_NO_OBJECT && w->waits != id)
		ob_free_end_wait(w->u, w->waits);
	w->waits = id;
}

static void step(worker *w, ob_free_sim *s)
{
	ob_worker_set_object(w->u, w->worker, s->id);
	turn_to(w, OB_TRACE_STEPS, 0, 0);
	ob_free_sim_step(s, &w->scratch);
	note_time(w, s);
	w->span.a++;
	ob_fault_chance_of(w->u, w->worker, &w->fault_chances);
}

// Sleeps for as long as nothing can be done. A simulator that is killed while it lowers a flight may not have said so: if nobody
// has, looks at all.
static void wait(worker *w)
{
	ob_free_sim *s = earliest_blocked(w);
	note_wait(w, s ? s->id : OB_NO_OBJECT);
	if (s) {
		turn_to(w, OB_TRACE_LAG, s->id, s->blocker);
		s->counts.waits++;
		s->counts.wait_ns += ob_free_wait_for(w->u, w->worker, w->word, s->id, s->blocker, s->needed);
		ob_free_put_counts(w->u, s->id, &s->counts);
	} else {
		turn_to(w, OB_TRACE_WAIT, 0, 0);
		ob_free_idle(w->u, w->worker, w->word, w->until, w->sims ? w->time[w->heap[0]] : INFINITY, UINT64_MAX);
	}
	for (uint32_t i = 0; i < w->sims && ob_free_word(w->u, w->worker) == w->word; i++)
		if (w->sim[i].aloft)
			look_at(w, &w->sim[i]);
}

static void work(worker *w)
{
	ob_free_sim *s = earliest(w);
	if (!s) {
		wait(w);
		return;
	}
	note_wait(w, OB_NO_OBJECT);
	if (wait_for_clock(w, s))
		return;
	if (ob_free_lag_allows(s, &w->scratch)) {
		step(w, s);
		return;
	}
	w->blocked[w->blocked_n++] = (uint32_t)(s - w->sim);
	set_key(w, (uint32_t)(s - w->sim), INFINITY);
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
		ob_free_idle(w->u, w->worker, ob_free_word(w->u, w->worker), w->until, 0, UINT64_MAX);
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
	if (ob_group_is(u))
		return ob_free_work_in_groups(u, number, e);
	if (!begin(&w, u, number))
		return ob_fail(e, "worker %u: no memory", number);
	bool fine = ob_free_schedule_open(&w.scratch.schedule, u, e) &&
		    (adopt(&w) || ob_fail(e, "no memory for worker %u", number));
	const bool replays = ob_free_schedule_replays(w.scratch.schedule);
	for (;;) {
		const uint32_t word = ob_free_word(u, number); // before all else that it may have moved for
		if (!fine || ob_gate_stopped(u))
			break;
		const uint32_t until = ob_free_until(u), entered = ob_free_entered(u);
		if (until != w.until || entered != w.entered)
			ob_counters_copy(ob_worker_counters(u, number),
					 &w.scratch.solver.counters); // their host looks now and then
		if (entered != w.entered)
			fine = adopt(&w) || ob_fail(e, "no memory for worker %u", number);
		w.until = until, w.entered = entered;
		look_at_lowered(&w, word);
		if (fine && replays)
			replay(&w);
		else if (fine)
			work(&w);
		fine = fine && ob_free_schedule_is_fine(w.scratch.schedule, e);
	}
	if (!fine) {
		ob_step_misses_plan(u, e->text);
		while (!ob_gate_stopped(u))
			ob_free_idle(u, number, ob_free_word(u, number), w.until, INFINITY, UINT64_MAX);
	}
	turn_to(&w, OB_TRACE_NONE, 0, 0);
	ob_counters_copy(ob_worker_counters(u, number), &w.scratch.solver.counters);
	finish(&w);
	return true;
}
