#include <stdlib.h>

#include "engine.h"
#include "host/host.h"
#include "lab/build.h"

static ob_object_def *define(const ob_peer_world *w)
{
	ob_object_def *def = calloc(w->objects, sizeof *def);
	for (uint32_t i = 0; def && i < w->objects; i++)
		def[i] = (ob_object_def){ .passport = w->passport[i], .state = w->state[i], .dies = INFINITY };
	return def;
}

static ob_run_settings settings_of(const ob_peer_settings *s, ob_vec3 gravity)
{
	return (ob_run_settings){
		.gravity = gravity,
		.step_length = s->step,
		.substeps = s->substeps,
		.passes = s->iterations,
		.tolerance = s->tolerance,
		.sleeping = s->sleeping,
	};
}

// The first go, to step 0, lets all objects look around: it belongs to setting up.
static bool run(ob_host *h, uint64_t steps, ob_host_times *times, ob_error *e)
{
	ob_host_times first;
	ob_host_go(h, 0);
	if (!ob_host_wait(h, e))
		return false;
	ob_host_get_times(h, &first);
	ob_host_go(h, steps);
	if (!ob_host_wait(h, e))
		return false;
	ob_host_get_times(h, times);
	times->cpu_s -= first.cpu_s;
	times->wall_s -= first.wall_s;
	return true;
}

static bool print(ob_host *h, const ob_host_times *t, double bodies, double steps, double before, ob_error *e)
{
	ob_snapshot now = { 0 };
	bench_print("bodies", "1", bodies);
	bench_print("steps", "1", steps);
	bench_print("cpu", "us/body-step", 1e6 * t->cpu_s / (steps * bodies));
	bench_print("wall", "us/step", 1e6 * t->wall_s / steps);
	bench_print("median step", "us", 1e6 * t->step_p50_s);
	bench_print("start-up", "us/body", 1e6 * t->startup_s / bodies);
	bench_print("memory", "B/body", ((double)t->memory_bytes - before) / bodies);
	bool taken = ob_snapshot_take(&now, ob_host_universe(h), false, e);
	if (taken)
		bench_print_state(ob_measure_hash(&now));
	ob_snapshot_finish(&now);
	return taken;
}

bool bench_time_host(const bench_order *o, ob_error *e)
{
	ob_peer_world w;
	bench_build(o, &w);
	ob_scene scene = { .title = "bench", .gravity = w.gravity, .step = o->settings.step, .objects = w.objects };
	scene.object = define(&w);
	ob_host_config config = { .workers = o->workers, .run = settings_of(&o->settings, w.gravity) };
	config.isolation = o->processes ? OB_ISOLATION_PROCESS : OB_ISOLATION_THREAD;
	double before = bench_memory();
	ob_host *h = scene.object ? ob_host_start(&scene, &config, e) : NULL;
	uint64_t steps = (uint64_t)lround(o->duration / o->settings.step);
	ob_host_times times;
	bool done = h && run(h, steps, &times, e) && print(h, &times, bench_bodies(&w), (double)steps, before, e);
	ob_host_stop(h);
	free(scene.object);
	ob_build_finish(&w);
	return done;
}
