// STOP ends every wait, at any state of the gate; a host without a turn returns after its timeout.
#include "../check.h"

#include <unistd.h>

#include "base/clock.h"
#include "workers.h"
#include "table/table.h"

enum { WORKERS = 70 };

typedef struct board {
	ob_universe *u;
	uint32_t runs;
} board;

// Worker 0 never comes back from its phase until the gate is stopped, so the phase cannot end.
static int work(void *shared, uint32_t worker)
{
	board *b = shared;
	if (ob_turn_wait(b->u, worker) != OB_PHASE_BROADPHASE)
		return 1;
	__atomic_fetch_add(&b->runs, 1, __ATOMIC_RELAXED);
	if (worker != 0 && ob_turn_arrive(b->u, worker))
		return 2;
	return worker != 0 && ob_turn_wait(b->u, worker) != OB_PHASE_STOP;
}

static void stop_in_phase(bool processes)
{
	board *b = shared_memory(sizeof *b);
	ob_error e;
	ob_universe_setup setup = { .capacity = 1, .workers = WORKERS, .isolation = "thread" };
	b->u = ob_universe_create(&setup, &e);
	CHECK(b->u);
	if (!b->u)
		return;
	worker_group g = { .processes = processes, .count = WORKERS, .run = work, .shared = b };
	CHECK(worker_group_start(&g));
	CHECK(ob_gate_host_wait(b->u, 0)); // the host has the first turn
	ob_gate_open(b->u, OB_PHASE_BROADPHASE, NULL, 0);
	double start = ob_clock_wall();
	CHECK(!ob_gate_host_wait(b->u, .2));
	double waited = ob_clock_wall() - start;
	CHECK(waited >= .2); // not woken early
	while (__atomic_load_n(&b->runs, __ATOMIC_RELAXED) < WORKERS)
		usleep(1000);
	usleep(20000); // most now sleep at the gate
	ob_gate_stop(b->u);
	CHECK(ob_gate_host_wait(b->u, 0));
	CHECK(worker_group_join(&g) == 0);
	for (uint32_t i = 0; i < WORKERS; i++)
		CHECK(ob_turn_wait(b->u, i) == OB_PHASE_STOP);
	ob_universe_destroy(b->u, true);
}

int main(void)
{
	stop_in_phase(false);
	stop_in_phase(true);
	return check_end();
}
