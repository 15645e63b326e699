#include <stdio.h>
#include <stdlib.h>

#include "engine.h"
#include "host/host.h"
#include "engine/world.h"

static ob_object_def *define(const ob_world *w)
{
	ob_object_def *def = calloc(w->objects, sizeof *def);
	for (uint32_t i = 0; def && i < w->objects; i++)
		def[i] = (ob_object_def){ .passport = w->passport[i], .state = w->state[i], .dies = INFINITY };
	return def;
}

// The host runs by itself from "from" to the end; the first run, to step 0, does the broad phase of all objects.
typedef struct watched {
	ob_world w;
	ob_scene scene;
	ob_host *h;
	double bodies;
	uint64_t from, steps; // end of the part that is not measured; total
	ob_host_times before, after;
	ob_counters counted_before, counted_after;
} watched;

static bool start(watched *r, const bench_order *o, bool timed, ob_error *e)
{
	bench_build(o, &r->w);
	r->bodies = bench_bodies(&r->w);
	r->from = (uint64_t)lround(o->from / o->settings.step_length);
	r->steps = (uint64_t)lround(o->duration / o->settings.step_length);
	ob_run_settings settings = o->settings;
	settings.gravity = r->w.gravity;
	settings.timed = timed;
	r->scene = (ob_scene){ .title = "bench", .run = settings };
	r->scene.objects = r->w.objects;
	r->scene.object = define(&r->w);
	ob_host_config config = { .workers = o->workers, .run = settings };
	config.isolation = o->processes ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
	r->h = r->scene.object ? ob_host_start(&r->scene, &config, e) : NULL;
	return r->h;
}

static bool go(watched *r, uint64_t step, ob_host_times *times, ob_counters *counted, ob_error *e)
{
	ob_host_go(r->h, step);
	if (!ob_host_wait(r->h, e))
		return false;
	ob_host_get_times(r->h, times);
	ob_universe_count(ob_host_universe(r->h), counted);
	return true;
}

static bool run(watched *r, ob_error *e)
{
	return go(r, 0, &r->before, &r->counted_before, e) &&
	       (!r->from || go(r, r->from, &r->before, &r->counted_before, e)) &&
	       go(r, r->steps, &r->after, &r->counted_after, e);
}

static void end(watched *r)
{
	ob_host_stop(r->h);
	free(r->scene.object);
	ob_world_finish(&r->w);
}

static bool print(const watched *r, ob_error *e)
{
	const ob_host_times *t = &r->after;
	ob_snapshot now = { 0 };
	double steps = (double)r->steps;
	bench_print("bodies", "1", r->bodies);
	bench_print("steps", "1", steps);
	bench_print("cpu", "us/body-step", 1e6 * (t->cpu_s - r->before.cpu_s) / (steps * r->bodies));
	bench_print("wall", "us/step", 1e6 * (t->wall_s - r->before.wall_s) / steps);
	bench_print("median step", "us", 1e6 * t->step_p50_s);
	bench_print("start-up", "us/body", 1e6 * t->startup_s / r->bodies);
	bool taken = ob_snapshot_take(&now, ob_host_universe(r->h), 0, e);
	if (taken)
		bench_print_state(ob_measure_hash(&now));
	ob_snapshot_finish(&now);
	return taken;
}

bool bench_time_host(const bench_order *o, ob_error *e)
{
	watched r = { 0 };
	bench_order all = *o;
	all.from = 0;
	bool done = start(&r, &all, false, e) && run(&r, e) && print(&r, e);
	end(&r);
	return done;
}

static void print_parts(const watched *r)
{
	const ob_counters *a = &r->counted_before, *b = &r->counted_after;
	double all = r->bodies * (double)(r->steps - r->from), sum = 0;
	for (uint32_t part = 0; part < OB_PROFILE_SECTIONS; part++) {
		char name[64];
		double us = 1e-3 * (double)(b->time_ns[part] - a->time_ns[part]) / all;
		snprintf(name, sizeof name, "part: %s", ob_profile_name(part));
		bench_print(name, "us/body-step", us);
		sum += us;
	}
	double cpu = 1e6 * (r->after.cpu_s - r->before.cpu_s) / all;
	bench_print("part: gate and the rest", "us/body-step", cpu - sum);
	bench_print("cpu, timed", "us/body-step", cpu);
	double critical = r->after.critical_s - r->before.critical_s;
	bench_print("critical path", "us/step", 1e6 * critical / (double)(r->steps - r->from));
	const double simulated = r->after.simulated_s - r->before.simulated_s;
	bench_print("critical path, 16 workers", "us/step", 1e6 * simulated / (double)(r->steps - r->from));
	bench_print("arranged by one worker alone", "us/body-step", 1e6 * (r->after.alone_s - r->before.alone_s) / all);
	bench_print("speed-up of 16 workers", "1", 1e-6 * sum * all / simulated);
#define COUNT(what) bench_print("count: " #what, "1/body-step", (double)(b->what - a->what) / all)
	COUNT(ballistic_advances);
	COUNT(body_steps);
	COUNT(body_substeps);
	COUNT(island_steps);
	COUNT(islands_redone);
	COUNT(narrowphase_tests);
	COUNT(swept_tests);
	COUNT(box_tests);
	COUNT(solver_iterations);
	COUNT(pair_solves);
	COUNT(impacts);
	COUNT(direct_solves);
	COUNT(gyroscopic_steps);
#undef COUNT
}

bool bench_parts(const bench_order *o, ob_error *e)
{
	watched r = { 0 };
	bool done = start(&r, o, true, e) && run(&r, e);
	if (done)
		print_parts(&r);
	end(&r);
	return done;
}
