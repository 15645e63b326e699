// One run of one engine in one scene: what it costs, or how far off it is. Prints a line for each quantity:
//
//   quantity<TAB>unit<TAB>value
//
// Time is that of stepping alone: making the world, and looking at it, is not counted. A run that is looked at takes no
// times, for looking fills the caches with something else.
#ifndef BENCH_ENGINE_H
#define BENCH_ENGINE_H

#include "scene.h"

typedef struct bench_order {
	const bench_scene *scene;
	double from, duration; // s: parts are told of what comes after "from"
	ob_run_settings settings;
	uint32_t workers; // through the host: of the pool
	bool processes; // through the host: workers are processes
} bench_order;

// An engine in this thread. false and e: it could not be made, or gave up.
bool bench_time(const bench_order *o, const ob_engine_kind *kind, ob_error *e);
bool bench_look(const bench_order *o, const ob_engine_kind *kind, ob_error *e);
// obsim as a user runs it: a host with a pool of workers, nobody looking on.
bool bench_time_host(const bench_order *o, ob_error *e);
// Likewise: the share of each part of the step in the CPU time, and how much of what was done.
bool bench_parts(const bench_order *o, ob_error *e);

void bench_print(const char *quantity, const char *unit, double value);
void bench_print_state(uint64_t hash); // of the bits of the state at the end: the same run gives the same
uint32_t bench_bodies(const ob_world *w); // that move
// Inertia of all bodies as the host computes it: then whoever runs the scene ends in the same bits.
void bench_build(const bench_order *o, ob_world *w);
// Bytes that this process has written to, shared segments included, programs and libraries not
double bench_memory(void);

#endif
