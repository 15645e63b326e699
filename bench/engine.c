#include "engine.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "engine/world.h"
#include "lab/scene.h"
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
	ob_error e;
	ob_scene *scene = NULL;
	*w = (ob_world){ .gravity = { 0, 0, -OB_WORLD_GRAVITY } };
	if (o->scene->build) {
		o->scene->build(w, o->scene->bodies);
	} else if (!(scene = ob_lab_scene_load(&o->scene->of, 0, w, &e))) {
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

// Errors of a world of any size, at frames.
typedef struct errors {
	double start, lowest, most; // J: energy; largest deviation of bodies that keep it
	double squares, growth; // J^2, of those; J
	double worst, rest_worst, rest_sum; // m
	uint32_t frames, rests;
} errors;

static void look(const bench_order *o, const ob_world *w, const ob_snapshot *now, errors *r)
{
	ob_penetration p;
	const double energy = ob_measure_energy(now, w->gravity);
	if (!r->frames++)
		r->start = r->lowest = energy;
	r->most = fmax(r->most, fabs(energy - r->start));
	r->squares += (energy - r->start) * (energy - r->start);
	r->lowest = fmin(r->lowest, energy);
	r->growth = fmax(r->growth, energy - r->lowest);
	ob_measure_penetration(now, &p);
	r->worst = fmax(r->worst, p.max_m);
	if (now->time > o->duration - 1) {
		r->rest_worst = fmax(r->rest_worst, p.max_m);
		r->rest_sum += p.mean_m;
		r->rests++;
	}
}

static void print_errors(const errors *r, bool elastic)
{
	if (elastic) {
		bench_print("error of energy", "1", r->most / r->start);
		bench_print("mean squared error of energy", "J^2", r->squares / fmax(r->frames - 1., 1));
		return;
	}
	bench_print("resting mean penetration", "mm", 1e3 * r->rest_sum / fmax(r->rests, 1));
	bench_print("resting worst penetration", "mm", 1e3 * r->rest_worst);
	bench_print("worst penetration at any moment", "mm", 1e3 * r->worst);
	bench_print("growth of energy", "1", r->growth / r->start);
}

static bool look_at_world(const bench_order *o, const ob_engine_kind *kind, ob_error *e)
{
	ob_world w;
	ob_snapshot now = { 0 };
	errors r = { 0 };
	bench_build(o, &w);
	const double h = o->settings.step_length;
	const long steps = lround(o->duration / h), frame = lround(fmax(ob_case_step / h, 1));
	ob_engine *p = kind->create(&w, &o->settings, e);
	ob_state *state = calloc(w.objects, sizeof *state);
	bool on = p && ((ob_lab_snapshot_begin(&now, &w) && state) || ob_fail(e, "out of memory"));
	for (long i = 0; on && i <= steps; i++) {
		if (i % frame == 0) {
			kind->get(p, state);
			ob_lab_snapshot_take(&now, (double)i * h, state);
			look(o, &w, &now, &r);
		}
		on = i == steps || kind->step(p, e);
	}
	if (on)
		print_errors(&r, o->scene->elastic);
	ob_lab_snapshot_end(&now);
	if (p)
		kind->destroy(p);
	free(state);
	ob_world_finish(&w);
	return on;
}

bool bench_look(const bench_order *o, const ob_engine_kind *kind, ob_error *e)
{
	if (o->scene->build)
		return look_at_world(o, kind, e);
	ob_case c = o->scene->of;
	ob_case_result out;
	c.duration = o->duration;
	if (!ob_case_run(&c, kind, &o->settings, &out, e))
		return false;
	for (uint32_t i = 0; i < c.figures; i++)
		bench_print(c.figure[i].name, c.figure[i].unit, out.figure[i]);
	return !out.failed[0] || ob_fail(e, "%s", out.failed);
}
