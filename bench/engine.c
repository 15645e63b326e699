#include "engine.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "world/world.h"
#include "lab/look.h"
#include "ode/ode_body.h"
#include "shape/shape.h"

void bench_print(const char *quantity, const char *unit, double value)
{
	printf("%s\t%s\t%.9g\n", quantity, unit, value);
}

void bench_print_state(uint64_t hash)
{
	printf("state\tbits\t%016" PRIx64 "\n", hash);
}

uint32_t bench_bodies(const ob_world *w)
{
	uint32_t bodies = 0;
	for (uint32_t id = 0; id < w->objects; id++)
		bodies += !(w->passport[id].flags & OB_OBJECT_STATIC);
	return bodies;
}

void bench_build(const bench_order *o, ob_world *w)
{
	ob_scene *scene;
	ob_error e;
	if (!ob_case_build(&o->scene->of, 0, w, &scene, &e)) {
		fprintf(stderr, "%s\n", e.text);
		exit(1);
	}
	ob_scene_free(scene);
	for (uint32_t id = 0; id < w->objects; id++) {
		ob_passport *p = &w->passport[id];
		if (!(p->flags & OB_OBJECT_STATIC))
			p->inertia = ob_shape_inertia(p->shape, p->size, NULL, p->mass);
	}
}

double bench_memory(void)
{
	size_t kib, sum = 0;
	char line[128];
	FILE *f = fopen("/proc/self/smaps_rollup", "re");
	while (f && fgets(line, sizeof line, f))
		if (sscanf(line, "Pss_Anon: %zu kB", &kib) == 1 || sscanf(line, "Pss_Shmem: %zu kB", &kib) == 1)
			sum += kib;
	if (f)
		fclose(f);
	return 1024. * (double)sum;
}

static uint64_t hash_of(const ob_engine *p, const ob_engine_kind *kind, const ob_world *w, double time)
{
	ob_snapshot now = { .time = time, .count = w->objects, .passport = w->passport };
	ob_state *state = calloc(w->objects, sizeof *state);
	now.motion = calloc(w->objects, sizeof *now.motion);
	uint64_t hash = 0;
	if (state && now.motion) {
		kind->get(p, state);
		for (uint32_t i = 0; i < w->objects; i++) {
			const ob_state *s = &state[i];
			now.motion[i] = (ob_motion){ .t0 = time, .p = s->pose.p, .q = s->pose.q, .v = s->v };
			now.motion[i].w = s->w;
		}
		hash = ob_measure_hash(&now);
	}
	free(state);
	free(now.motion);
	return hash;
}

bool bench_time(const bench_order *o, const ob_engine_kind *kind, ob_error *e)
{
	ob_world w;
	bench_build(o, &w);
	double bodies = bench_bodies(&w), before = bench_memory();
	ob_engine *p = kind->create(&w, &o->settings, e);
	if (!p)
		return ob_world_finish(&w), false;
	long steps = lround(o->duration / o->settings.step_length), done = 0;
	double wall = ob_clock_wall(), cpu = ob_clock_thread_cpu();
	bool on = true;
	for (; on && done < steps; done++)
		on = kind->step(p, e);
	cpu = ob_clock_thread_cpu() - cpu;
	wall = ob_clock_wall() - wall;
	bench_print("bodies", "1", bodies);
	bench_print("steps", "1", (double)done);
	bench_print("cpu", "us/body-step", 1e6 * cpu / ((double)done * bodies));
	bench_print("wall", "us/step", 1e6 * wall / (double)done);
	bench_print("memory", "B/body", (bench_memory() - before) / bodies);
	bench_print_state(hash_of(p, kind, &w, (double)done * o->settings.step_length));
	kind->destroy(p);
	ob_world_finish(&w);
	return on;
}

bool bench_look(const bench_order *o, const ob_engine_kind *kind, ob_error *e)
{
	ob_case c = o->scene->of;
	ob_case_result out;
	c.duration = o->duration;
	if (!ob_case_run(&c, kind, &o->settings, &out, e))
		return false;
	for (uint32_t i = 0; i < c.figures; i++)
		bench_print(c.figure[i].name, c.figure[i].unit, out.figure[i]);
	return !out.failed[0] || ob_fail(e, "%s", out.failed);
}
