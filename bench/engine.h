// One run of one engine in one scene: its cost, or its error. Prints a line for each quantity:
//
//   quantity<TAB>unit<TAB>value
//
// Times are of stepping alone, without making the world and observing it. A run with observations gives no times, as
// observing fills the caches with other data.
#ifndef BENCH_ENGINE_H
#define BENCH_ENGINE_H

#include "scene.h"

typedef struct bench_order {
	const bench_scene *scene;
	double from, duration; // s: parts are measured after "from"
	ob_run_settings settings;
	uint32_t workers; // through the host: size of the pool
	bool processes; // through the host: workers are processes
} bench_order;

// Runs an engine in this thread. Returns false and e if it could not be created, or gave up.
bool bench_time(const bench_order *o, const ob_engine_kind *kind, ob_error *e);
bool bench_look(const bench_order *o, const ob_engine_kind *kind, ob_error *e);
// Runs obsim as a user does: a host with a pool of workers, without observers.
bool bench_time_host(const bench_order *o, ob_error *e);
// Same run: the share of each part of the step in the CPU time, and counts of operations.
bool bench_parts(const bench_order *o, ob_error *e);

void bench_print(const char *quantity, const char *unit, double value);
void bench_print_state(uint64_t hash); // hash of the state's bits at the end: the same run gives the same
uint32_t bench_bodies(const ob_world *w); // number of moving bodies
// Builds the scene with the inertia that the host computes: all runs of the scene then end in the same bits.
void bench_build(const bench_order *o, ob_world *w);
// Bytes that this process has written to, including shared segments, without programs and libraries.
double bench_memory(void);

#endif
