// The trace's rings: written events are read, in order and whole, or counted as lost; from threads, from processes, and
// from killed processes.
#include "../check.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "workers.h"
#include "table/layout.h"
#include "table/trace.h"

enum { WORKERS = 4, EVENTS = 300000, BATCH = 777 };

typedef struct board {
	ob_universe *u;
	uint32_t running;
} board;

static ob_universe *create(uint32_t workers, bool traced)
{
	ob_error e = { "" };
	ob_universe_setup setup = { .capacity = 8, .workers = workers, .isolation = "thread", .traced = traced };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u)
		fprintf(stderr, "%s\n", e.text);
	CHECK(u);
	return u;
}

// Event n of a ring has n in each of its words.
static void tell(ob_universe *u, uint32_t ring, uint32_t n)
{
	ob_trace_doing(u, ring, OB_TRACE_SOLVE, 1000 + n);
	ob_trace_span(u, ring, OB_TRACE_CHUNK, n, n, ~n);
}

static int write_many(void *shared, uint32_t worker)
{
	board *b = shared;
	for (uint32_t n = 0; n < EVENTS; n++)
		tell(b->u, worker, n);
	__atomic_sub_fetch(&b->running, 1, __ATOMIC_RELEASE);
	return 0;
}

// Reads a ring; returns the number of events. wrong: torn ones, and ones out of order.
static uint32_t read_ring(ob_universe *u, uint32_t ring, uint32_t *next, uint32_t *wrong)
{
	static ob_trace_event taken[BATCH];
	uint32_t n = ob_trace_take(u, ring, taken, BATCH);
	for (uint32_t i = 0; i < n; i++) {
		const ob_trace_event *e = &taken[i];
		*wrong +=
			e->kind != OB_TRACE_CHUNK || e->b != ~e->a || e->begin != e->a || e->a < *next || e->step != 1;
		*next = e->a + 1;
	}
	return n;
}

static void test_many_writers(bool processes)
{
	board *b = shared_memory(sizeof *b);
	uint32_t next[WORKERS] = { 0 }, wrong = 0;
	uint64_t read = 0, lost = 0;
	b->u = create(WORKERS, true);
	if (!b->u)
		return;
	b->running = WORKERS;
	worker_group g = { .processes = processes, .count = WORKERS, .run = write_many, .shared = b };
	CHECK(worker_group_start(&g));
	for (bool last = false; !last;) {
		last = __atomic_load_n(&b->running, __ATOMIC_ACQUIRE) == 0;
		for (uint32_t w = 0; w < WORKERS; w++)
			for (uint32_t n; (n = read_ring(b->u, w, &next[w], &wrong));)
				read += n;
		nanosleep(&(struct timespec){ .tv_nsec = 1000000 }, NULL);
	}
	CHECK(worker_group_join(&g) == 0);
	for (uint32_t w = 0; w < WORKERS; w++)
		lost += ob_trace_lost(b->u, w);
	CHECK(wrong == 0);
	CHECK(read + lost == (uint64_t)WORKERS * EVENTS);
	CHECK(read > 0);
	printf("%s: %llu read, %llu lost\n", processes ? "processes" : "threads", (unsigned long long)read,
	       (unsigned long long)lost);
	ob_universe_destroy(b->u, true);
}

// A full ring keeps its events; new ones are lost until the reader takes some.
static void test_full(void)
{
	ob_universe *u = create(1, true);
	if (!u)
		return;
	uint32_t size = u->header.sizes.trace_events, next = 0, wrong = 0, read = 0;
	CHECK(size >= 256 && (size & (size - 1)) == 0);
	for (uint32_t n = 0; n < size + 100; n++)
		tell(u, 0, n);
	CHECK(ob_trace_lost(u, 0) == 100 && ob_trace_lost(u, 1) == 0);
	for (uint32_t n; (n = read_ring(u, 0, &next, &wrong));)
		read += n;
	CHECK(read == size && next == size && wrong == 0);
	tell(u, 0, size + 100);
	CHECK(read_ring(u, 0, &next, &wrong) == 1 && next == size + 101 && wrong == 0);
	CHECK(ob_trace_lost(u, 0) == 100);
	ob_universe_destroy(u, true);
}

// A process killed at any point leaves whole events, and its current activity.
static void test_killed(void)
{
	uint32_t wrong = 0, idle = 0, total = 0;
	for (int kill_no = 0; kill_no < 60; kill_no++) {
		ob_universe *u = create(1, true);
		if (!u)
			return;
		uint32_t next = 0, read = 0;
		pid_t pid = fork();
		if (pid == 0)
			for (uint32_t n = 0;; n++)
				tell(u, 0, n);
		while (read < 1000)
			read += read_ring(u, 0, &next, &wrong);
		nanosleep(&(struct timespec){ .tv_nsec = 37000 * (kill_no % 10) }, NULL);
		kill(pid, SIGKILL);
		waitpid(pid, NULL, 0);
		for (uint32_t n; (n = read_ring(u, 0, &next, &wrong));)
			read += n;
		ob_trace_event doing = ob_trace_unfinished(u, 0);
		idle += doing.kind != OB_TRACE_SOLVE;
		wrong += ob_trace_lost(u, 0) == 0 && doing.begin != 1000 + (uint64_t)next && doing.begin != 999 + next;
		total += read;
		ob_universe_destroy(u, true);
	}
	CHECK(wrong == 0);
	CHECK(idle == 0);
	printf("killed 60 times after %u events in all\n", total);
}

static void test_states(void)
{
	ob_universe *u = create(1, true);
	ob_trace_event e[4];
	if (!u)
		return;
	ob_trace_birth(u, 5);
	uint64_t born = ob_trace_since(u, 5);
	ob_trace_moves(u, 0, 5, OB_MOTION_FREE, OB_MOTION_FREE);
	CHECK(ob_trace_take(u, 0, e, 4) == 0);
	ob_trace_moves(u, 0, 5, OB_MOTION_FREE, 0);
	ob_trace_moves(u, 0, 5, 0, OB_MOTION_ASLEEP);
	CHECK(ob_trace_take(u, 0, e, 4) == 2);
	CHECK(e[0].kind == OB_TRACE_STATE && e[0].a == 5 && e[0].begin == born && e[0].end == e[1].begin);
	CHECK(e[0].b == (OB_TRACE_FLYING | OB_TRACE_TOUCHING << 8));
	CHECK(e[1].b == (OB_TRACE_TOUCHING | OB_TRACE_ASLEEP << 8) && e[1].end == ob_trace_since(u, 5));
	ob_trace_death(u, 5, OB_MOTION_ASLEEP);
	CHECK(ob_trace_take(u, ob_trace_host(u), e, 4) == 3);
	CHECK(e[0].kind == OB_TRACE_BIRTH && e[1].b == OB_TRACE_ASLEEP && e[2].kind == OB_TRACE_DEATH);
	CHECK(ob_trace_unfinished(u, 0).kind == OB_TRACE_NONE);
	ob_universe_destroy(u, true);
}

// Untraced, nothing is reserved; traced, a reader can attach all the same.
static void test_layout(void)
{
	ob_error e;
	ob_universe *plain = create(3, false);
	if (!plain)
		return;
	CHECK(!ob_universe_traced(plain) && plain->header.sizes.trace_events == 0);
	CHECK(plain->header.area[OB_AREA_TRACE_SINCE] == plain->header.bytes);
	uint64_t bytes = plain->header.bytes;
	ob_universe_destroy(plain, true);
	ob_universe *u = create(3, true);
	ob_universe *r = u ? ob_universe_attach(ob_universe_name(u), &e) : NULL;
	CHECK(r && ob_universe_traced(r) && r->header.bytes > bytes);
	CHECK(ob_trace_rings(u) == 5 && ob_trace_host(u) == 3 && ob_trace_supervisor(u) == 4);
	ob_universe_detach(r);
	ob_universe_destroy(u, true);
}

int main(void)
{
	test_layout();
	test_states();
	test_full();
	test_many_writers(false);
	test_many_writers(true);
	test_killed();
	return check_end();
}
