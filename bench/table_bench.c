// Cost of the table: publishing and reading a slot, and the gate per object in a pool and with one worker per object.
// Medians of several runs, on an otherwise idle machine. Targets are printed beside the figures.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sched.h>

#include "base/clock.h"
#include "base/cpu.h"
#include "table/slot.h"
#include "table/table.h"
#include "../tests/table/workers.h"

enum { RUNS = 7, OBJECTS = 1000, SLOT_ROUNDS = 2000000 };

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static void report(const char *what, double run[RUNS], const char *unit, double target)
{
	qsort(run, RUNS, sizeof *run, ascending);
	printf("%-44s %8.3f %s  (%.3f .. %.3f, target %g)\n", what, run[RUNS / 2], unit, run[0], run[RUNS - 1], target);
	fflush(stdout);
}

static ob_universe *create(uint32_t workers, const char *isolation)
{
	ob_error e;
	ob_universe_setup setup = { .capacity = OBJECTS, .workers = workers, .isolation = isolation };
	ob_universe *u = ob_universe_create(&setup, &e);
	if (!u) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	return u;
}

// ---- slots: 64 objects in turn, for the figures of a warm cache

static void bench_slots(void)
{
	ob_universe *u = create(1, "thread");
	double publish[RUNS], read[RUNS], reader[RUNS], sum = 0;
	ob_motion m = { .q = { 1, 0, 0, 0 } };
	for (uint32_t i = 0; i < 64; i++) {
		ob_passport p = { .id = i, .flags = OB_OBJECT_PRESENT, .shape = OB_SHAPE_SPHERE };
		ob_write_passport(u, i, &p);
	}
	ob_slot *slot = aligned_alloc(64, 64 * sizeof *slot);
	memset(slot, 0, 64 * sizeof *slot);
	for (int r = 0; r < RUNS; r++) {
		double start = ob_clock_wall();
		for (uint32_t i = 0; i < SLOT_ROUNDS; i++) {
			m.t0 = i;
			ob_publish_motion(u, i % 64, &m);
		}
		publish[r] = (ob_clock_wall() - start) / SLOT_ROUNDS * 1e9;
		for (uint32_t i = 0; i < 64; i++)
			ob_slot_publish(slot + i, &m);
		start = ob_clock_wall();
		for (uint32_t i = 0; i < SLOT_ROUNDS; i++)
			sum += ob_slot_read(slot + i % 64, &m) ? m.t0 : 0;
		read[r] = (ob_clock_wall() - start) / SLOT_ROUNDS * 1e9;
		start = ob_clock_wall();
		for (uint32_t i = 0; i < SLOT_ROUNDS; i++)
			sum += ob_universe_get_motion(u, i % 64, &m) ? m.t0 : 0;
		reader[r] = (ob_clock_wall() - start) / SLOT_ROUNDS * 1e9;
	}
	report("publish", publish, "ns", 15);
	report("read", read, "ns", 15);
	report("read, with a reader's checks", reader, "ns", 40);
	if (sum == 0)
		puts("nothing was read");
	free(slot);
	ob_universe_destroy(u, true);
}

// ---- the gate

typedef struct board {
	ob_universe *u;
	uint64_t gates; // remaining gates
	bool pool; // workers claim objects; otherwise each has its own
	uint32_t stride; // participants are every stride-th worker
	uint32_t participants[OBJECTS];
} board;

static void open_next(board *b)
{
	uint32_t n = ob_universe_workers(b->u) / b->stride;
	ob_task_reset(b->u, OBJECTS, 1);
	ob_gate_open(b->u, OB_PHASE_BROADPHASE, b->stride == 1 ? NULL : b->participants, n);
}

static int work(void *shared, uint32_t worker)
{
	board *b = shared;
	ob_cpu_pin(worker);
	ob_motion m = { .q = { 1, 0, 0, 0 } };
	while (ob_turn_wait(b->u, worker) != OB_PHASE_STOP) {
		uint32_t object = worker;
		if (!b->pool)
			ob_publish_motion(b->u, object, &m);
		while (b->pool && ob_task_claim(b->u, &object))
			ob_publish_motion(b->u, object, &m);
		if (!ob_turn_arrive(b->u, worker))
			continue;
		if (--b->gates == 0)
			ob_gate_pause(b->u);
		else
			open_next(b);
	}
	return 0;
}

static void bench_gate(const char *what, bool processes, uint32_t workers, uint32_t stride, uint64_t gates,
		       double target)
{
	board *b = shared_memory(sizeof *b);
	b->u = create(workers, processes ? "process" : "thread");
	b->pool = workers < OBJECTS;
	b->stride = stride;
	for (uint32_t i = 0; i < workers / stride; i++)
		b->participants[i] = i * stride;
	worker_group g = { .processes = processes, .count = workers, .run = work, .shared = b };
	if (!worker_group_start(&g))
		exit(1);
	double run[RUNS];
	uint32_t objects = b->pool ? OBJECTS : workers / stride;
	for (int r = -1; r < RUNS; r++) { // one run to warm up
		b->gates = gates;
		double start = ob_clock_wall();
		open_next(b);
		if (!ob_gate_host_wait(b->u, 120))
			exit(1);
		run[r < 0 ? 0 : r] = (ob_clock_wall() - start) / (double)gates / objects * 1e6;
	}
	report(what, run, "us", target);
	ob_gate_stop(b->u);
	worker_group_join(&g);
	ob_universe_destroy(b->u, true);
}

int main(void)
{
	printf("%d cores; us are per object and gate, publication included\n", ob_cpu_count());
	bench_slots();
	bench_gate("pool of 2 threads, 1000 objects", false, 2, 1, 3000, .15);
	bench_gate("pool of 2 processes, 1000 objects", true, 2, 1, 3000, .15);
	bench_gate("1000 threads, one object each", false, OBJECTS, 1, 50, 6);
	bench_gate("1000 processes, one object each", true, OBJECTS, 1, 50, 8);
	bench_gate("1000 threads, every 9th takes part", false, OBJECTS, 9, 300, 6);
	bench_gate("1000 processes, every 9th takes part", true, OBJECTS, 9, 300, 8);
	return 0;
}
