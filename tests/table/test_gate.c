// The gate: every phase runs in exactly its participants, once each, and the scheduler sees their writes before it
// opens the next. Arguments: threads|processes, workers, phases. Every 500 phases the host has the turn.
#include "../check.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "workers.h"
#include "table/table.h"

enum { WORKERS_MAX = 1024, PAUSE_EVERY = 500 };

// Plain data on purpose: only the gate orders it.
typedef struct board {
	ob_universe *u;
	uint64_t phases, phase; // to run; running
	uint64_t random;
	uint32_t n, participants[WORKERS_MAX];
	uint64_t part_of[WORKERS_MAX]; // last phase in which the worker takes part
	uint64_t ran_in[WORKERS_MAX]; // last phase in which it ran
	uint64_t runs[WORKERS_MAX], due[WORKERS_MAX];
	uint64_t missed, uninvited, kinds; // findings
} board;

static uint32_t next_random(board *b)
{
	b->random = b->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (uint32_t)(b->random >> 33);
}

// All workers, one, a random part, or a run of neighbours, so that groups are full, split, and empty.
static const uint32_t *choose(board *b, uint32_t workers)
{
	uint32_t kind = next_random(b) % 4, n = 0, first = next_random(b) % workers;
	uint32_t length = 1 + next_random(b) % workers, odds = 1 + next_random(b) % 20;
	b->kinds |= 1u << kind;
	for (uint32_t w = 0; w < workers; w++) {
		bool in = kind == 0 || (kind == 1 && w == first) || (kind == 2 && next_random(b) % odds == 0) ||
			  (kind == 3 && w >= first && w < first + length);
		if (in)
			b->participants[n++] = w;
	}
	if (n == 0)
		b->participants[n++] = first;
	b->n = n;
	for (uint32_t i = 0; i < n; i++) {
		b->part_of[b->participants[i]] = b->phase;
		b->due[b->participants[i]]++;
	}
	return kind == 0 ? NULL : b->participants;
}

static void open_next(board *b)
{
	b->phase++;
	const uint32_t *participants = choose(b, ob_universe_workers(b->u));
	ob_gate_open(b->u, b->phase % 2 ? OB_PHASE_BROADPHASE : OB_PHASE_ISLANDS, participants, b->n);
}

static void schedule(board *b)
{
	for (uint32_t i = 0; i < b->n; i++)
		b->missed += b->ran_in[b->participants[i]] != b->phase;
	if (b->phase == b->phases)
		ob_gate_open(b->u, OB_PHASE_STOP, NULL, 0);
	else if (b->phase % PAUSE_EVERY == 0)
		ob_gate_pause(b->u);
	else
		open_next(b);
}

static int work(void *shared, uint32_t worker)
{
	board *b = shared;
	for (;;) {
		ob_phase phase = ob_turn_wait(b->u, worker);
		if (phase == OB_PHASE_STOP)
			return 0;
		bool invited = b->part_of[worker] == b->phase && b->ran_in[worker] != b->phase &&
			       phase == (b->phase % 2 ? OB_PHASE_BROADPHASE : OB_PHASE_ISLANDS);
		if (!invited)
			__atomic_fetch_add(&b->uninvited, 1, __ATOMIC_RELAXED);
		b->ran_in[worker] = b->phase;
		b->runs[worker]++;
		if (ob_turn_arrive(b->u, worker))
			schedule(b);
	}
}

static void lead(board *b)
{
	for (;;) {
		bool came = ob_gate_host_wait(b->u, 60);
		CHECK(came);
		if (!came || b->phase == b->phases) // ordered by the turn, or by STOP
			return;
		open_next(b);
	}
}

int main(int argc, char **argv)
{
	bool processes = argc > 1 && strcmp(argv[1], "processes") == 0;
	uint32_t workers = argc > 2 ? (uint32_t)atoi(argv[2]) : 2;
	board *b = shared_memory(sizeof *b);
	ob_error e;
	ob_universe_setup setup = { .capacity = 16, .workers = workers, .isolation = argc > 1 ? argv[1] : "threads" };
	b->u = ob_universe_create(&setup, &e);
	CHECK(b->u && workers <= WORKERS_MAX);
	if (!b->u || workers > WORKERS_MAX) {
		fprintf(stderr, "%s\n", e.text);
		return check_end();
	}
	b->phases = argc > 3 ? (uint64_t)atoi(argv[3]) : 3000;
	b->random = workers;
	worker_group g = { .processes = processes, .count = workers, .run = work, .shared = b };
	CHECK(worker_group_start(&g));
	lead(b);
	CHECK(worker_group_join(&g) == 0);
	uint32_t wrong = 0;
	for (uint32_t w = 0; w < workers; w++)
		wrong += b->runs[w] != b->due[w];
	CHECK(wrong == 0);
	CHECK(b->missed == 0);
	CHECK(b->uninvited == 0);
	CHECK(b->phase == b->phases);
	CHECK(b->kinds == 15);
	CHECK(ob_turn_wait(b->u, 0) == OB_PHASE_STOP); // for good
	ob_universe_destroy(b->u, true);
	return check_end();
}
