#include "host/timeline.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/allocate.h"
#include "base/clock.h"
#include "base/interrupt.h"
#include "host/trace_file.h"
#include "table/table.h"

enum { PERIOD_MS = 50, TAKEN_AT_ONCE = 4096 };

// State of one ring. A span arrives when it ends, so inner spans arrive before the outer one. They wait for it, because
// the file must have the outer one first.
typedef struct ring_state {
	ob_trace_event *waiting;
	uint32_t count, room;
	uint64_t until; // ns: end of the last span of level 0
	uint64_t lost; // as of the last drain
	uint64_t died; // ns; 0 = alive
} ring_state;

struct ob_timeline {
	ob_universe *u;
	ob_trace_file *file;
	ring_state *ring; // [rings]
	uint64_t *state_until; // [capacity] ns: end of the last span of each object
	uint64_t events, lost;
	pthread_t thread;
	pthread_mutex_t lock; // guards ended
	pthread_cond_t end;
	bool ended;
	ob_trace_event taken[TAKEN_AT_ONCE];
};

static int level(uint32_t kind)
{
	return kind == OB_TRACE_CHUNK ? 1 : kind == OB_TRACE_ISLAND ? 2 : kind == OB_TRACE_PROFILE ? 3 : 0;
}

static int outer_first(const void *pa, const void *pb)
{
	const ob_trace_event *a = pa, *b = pb;
	if (a->begin != b->begin)
		return a->begin < b->begin ? -1 : 1;
	if (level(a->kind) != level(b->kind))
		return level(a->kind) - level(b->kind);
	return (a->end > b->end) - (a->end < b->end);
}

static void write_waiting(ob_timeline *t, uint32_t ring)
{
	ring_state *r = &t->ring[ring];
	if (r->count > 1)
		qsort(r->waiting, r->count, sizeof *r->waiting, outer_first);
	for (uint32_t i = 0; i < r->count; i++)
		ob_trace_file_put(t->file, ring, &r->waiting[i], false);
	r->count = 0;
}

static void keep_waiting(ob_timeline *t, uint32_t ring, const ob_trace_event *e)
{
	ring_state *r = &t->ring[ring];
	if (r->count == r->room) {
		uint32_t room = r->room ? 2 * r->room : 16;
		if (!OB_GROW(r->waiting, room)) {
			t->lost++;
			return;
		}
		r->room = room;
	}
	r->waiting[r->count++] = *e;
}

static void put(ob_timeline *t, uint32_t ring, const ob_trace_event *e)
{
	uint32_t capacity = ob_universe_capacity(t->u);
	bool objects = e->kind == OB_TRACE_STATE || e->kind == OB_TRACE_BIRTH || e->kind == OB_TRACE_DEATH;
	if (objects ? e->a >= capacity : e->kind == OB_TRACE_KILLED && e->a >= ob_universe_workers(t->u))
		return; // a damaged event: this program writes none like it
	if (objects || e->kind == OB_TRACE_KILLED) {
		if (e->kind == OB_TRACE_BIRTH)
			ob_trace_file_name_object(t->file, e->a);
		if (e->kind == OB_TRACE_KILLED)
			t->ring[e->a].died = e->end;
		if (objects && e->end > t->state_until[e->a])
			t->state_until[e->a] = e->end;
		ob_trace_file_put(t->file, ring, e, false);
		return;
	}
	keep_waiting(t, ring, e);
	if (level(e->kind) == 0) {
		t->ring[ring].until = e->end;
		write_waiting(t, ring);
	}
}

// Takes all events now in a ring; later ones may stay for the next time.
static void drain(ob_timeline *t, uint32_t ring)
{
	uint32_t n;
	do {
		n = ob_trace_take(t->u, ring, t->taken, TAKEN_AT_ONCE);
		t->events += n;
		for (uint32_t i = 0; i < n; i++)
			put(t, ring, &t->taken[i]);
	} while (n == TAKEN_AT_ONCE);
	uint64_t lost = ob_trace_lost(t->u, ring);
	if (lost == t->ring[ring].lost)
		return;
	ob_trace_file_put_lost(t->file, ring, lost - t->ring[ring].lost, ob_clock_ns());
	t->events += lost - t->ring[ring].lost;
	t->lost += lost - t->ring[ring].lost;
	t->ring[ring].lost = lost;
}

// Drains the host's ring first, so that an object is known as added before workers' events of its states.
static void drain_all(ob_timeline *t)
{
	for (uint32_t ring = ob_trace_rings(t->u); ring-- > 0;)
		drain(t, ring);
}

// true if the end came within the period
static bool wait_for_end(ob_timeline *t)
{
	struct timespec until;
	clock_gettime(CLOCK_MONOTONIC, &until);
	until.tv_nsec += PERIOD_MS * 1000000L;
	until.tv_sec += until.tv_nsec / 1000000000L;
	until.tv_nsec %= 1000000000L;
	pthread_mutex_lock(&t->lock);
	int late = 0;
	while (!t->ended && late == 0)
		late = pthread_cond_timedwait(&t->end, &t->lock, &until);
	bool ended = t->ended;
	pthread_mutex_unlock(&t->lock);
	return ended;
}

static void *run(void *argument)
{
	ob_timeline *t = argument;
	pthread_setname_np(pthread_self(), "timeline");
	do {
		drain_all(t);
		ob_trace_file_flush(t->file);
	} while (!wait_for_end(t));
	return NULL;
}

static bool start_thread(ob_timeline *t, ob_error *e)
{
	sigset_t before;
	pthread_condattr_t monotonic;
	pthread_mutex_init(&t->lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&t->end, &monotonic);
	pthread_condattr_destroy(&monotonic);
	ob_interrupt_leave_to_main(&before);
	int error = pthread_create(&t->thread, NULL, run, t);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (!error)
		return true;
	pthread_cond_destroy(&t->end);
	pthread_mutex_destroy(&t->lock);
	return ob_fail(e, "cannot start the timeline's thread: %s", strerror(error));
}

static void discard(ob_timeline *t)
{
	for (uint32_t i = 0; t->ring && i < ob_trace_rings(t->u); i++)
		free(t->ring[i].waiting);
	free(t->ring);
	free(t->state_until);
	free(t);
}

ob_timeline *ob_timeline_start(ob_universe *u, const char *path, ob_error *e)
{
	ob_timeline *t = calloc(1, sizeof *t);
	if (t) {
		t->u = u;
		t->ring = calloc(ob_trace_rings(u), sizeof *t->ring);
		t->state_until = calloc(ob_universe_capacity(u), sizeof *t->state_until);
	}
	if (!t || !t->ring || !t->state_until)
		ob_fail(e, "out of memory");
	else
		t->file = ob_trace_file_open(path, u, e);
	if (t && t->file && start_thread(t, e))
		return t;
	if (t && t->file)
		ob_trace_file_close(t->file, 0, 0, NULL);
	if (t)
		discard(t);
	return NULL;
}

// Writes the unfinished spans: current activity of workers, and states of objects.
static void put_unfinished(ob_timeline *t, const ob_trace_event *doing, uint64_t now)
{
	for (uint32_t ring = 0; ring < ob_universe_workers(t->u); ring++) {
		ob_trace_event e = doing[ring];
		e.end = t->ring[ring].died ? t->ring[ring].died : now;
		write_waiting(t, ring);
		if (e.kind != OB_TRACE_NONE && e.begin >= t->ring[ring].until && e.begin <= e.end)
			ob_trace_file_put(t->file, ring, &e, e.kind != OB_TRACE_WAIT);
	}
	for (uint32_t id = 0; id < ob_universe_ids(t->u); id++) {
		ob_passport p;
		ob_motion m;
		uint64_t since = ob_trace_since(t->u, id);
		if (!ob_universe_get_passport(t->u, id, &p) || p.flags & OB_OBJECT_PRESCRIBED ||
		    !ob_universe_get_motion(t->u, id, &m))
			continue;
		ob_trace_event e = { since > t->state_until[id] ? since : t->state_until[id],
				     now,
				     OB_TRACE_STATE,
				     id,
				     (uint32_t)ob_trace_motion_of(m.flags),
				     0 };
		ob_trace_file_put(t->file, 0, &e, true);
	}
}

static void finish_file(ob_timeline *t)
{
	uint32_t workers = ob_universe_workers(t->u);
	ob_trace_event *doing = calloc(workers, sizeof *doing);
	// activity of workers before the complete spans: a span that ends in between counts as complete
	for (uint32_t w = 0; doing && w < workers; w++)
		doing[w] = ob_trace_unfinished(t->u, w);
	drain_all(t);
	if (doing)
		put_unfinished(t, doing, ob_clock_ns());
	free(doing);
}

bool ob_timeline_finish(ob_timeline *t, const ob_death *deaths, uint32_t n, ob_timeline_sums *sums, ob_error *e)
{
	*sums = (ob_timeline_sums){ 0 };
	if (!t)
		return true;
	pthread_mutex_lock(&t->lock);
	t->ended = true;
	pthread_cond_signal(&t->end);
	pthread_mutex_unlock(&t->lock);
	pthread_join(t->thread, NULL);
	finish_file(t);
	for (uint32_t i = 0; i < n; i++) {
		ob_error line;
		ob_death_print(&deaths[i], line.text, sizeof line.text);
		ob_trace_file_put_death(t->file,
					deaths[i].worker < ob_universe_workers(t->u) ? deaths[i].worker
										     : ob_trace_supervisor(t->u),
					line.text, deaths[i].step, deaths[i].when);
	}
	*sums = (ob_timeline_sums){ t->events, t->lost };
	bool fine = ob_trace_file_close(t->file, t->events, t->lost, e);
	pthread_cond_destroy(&t->end);
	pthread_mutex_destroy(&t->lock);
	discard(t);
	return fine;
}
