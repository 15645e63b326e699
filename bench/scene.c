#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab/look.h"
#include "world/builders.h"

enum { MOST = 1000000 }; // bodies

static bench_scene scene;

// ---- worlds of any number of bodies

static void build_falling(ob_world *w, uint32_t run)
{
	ob_world_falling(w, scene.bodies, 100 + run);
}

static void build_cylinders(ob_world *w, uint32_t run)
{
	ob_world_falling_solids(w, OB_SHAPE_CYLINDER, scene.bodies, 100 + run);
}

static void build_capsules(ob_world *w, uint32_t run)
{
	ob_world_falling_solids(w, OB_SHAPE_CAPSULE, scene.bodies, 100 + run);
}

static void build_sparse(ob_world *w, uint32_t run)
{
	ob_world_sparse(w, scene.bodies, 200 + run);
}

static void build_balls(ob_world *w, uint32_t run)
{
	ob_world_balls(w, scene.bodies);
}

// ---- figures of bodies that fall and come to rest

// mm, mm, mm; the last: largest rise of the energy from its lowest so far, over the initial energy.
enum { HEAP_RESTING_MEAN, HEAP_RESTING_WORST, HEAP_WORST, HEAP_GROWTH, HEAP_FIGURES };
enum { MEMORY_SUM, MEMORY_FRAMES, MEMORY_START, MEMORY_LOWEST }; // resting penetrations (m); energies (J)

static void observe_heap(ob_case_run_state *t)
{
	double energy = ob_look_energy(t), *memory = t->memory;
	const ob_penetration p = ob_look_penetration(t, &t->figure[HEAP_WORST]);
	if (t->time > t->of->duration - 1) {
		memory[MEMORY_SUM] += p.mean_m;
		memory[MEMORY_FRAMES]++;
		ob_look_keep(&t->figure[HEAP_RESTING_WORST], 1e3 * p.max_m);
	}
	if (!t->frame)
		memory[MEMORY_START] = memory[MEMORY_LOWEST] = energy;
	memory[MEMORY_LOWEST] = fmin(memory[MEMORY_LOWEST], energy);
	ob_look_keep(&t->figure[HEAP_GROWTH], (energy - memory[MEMORY_LOWEST]) / memory[MEMORY_START]);
	ob_look_fail_below(t);
}

static void judge_heap(ob_case_run_state *t)
{
	t->figure[HEAP_RESTING_MEAN] = 1e3 * t->memory[MEMORY_SUM] / fmax(t->memory[MEMORY_FRAMES], 1);
	if (!t->failed && ob_look_farthest(t) < .1)
		t->failed = "nothing moved";
}

static void judge_crowd(ob_case_run_state *t)
{
	judge_heap(t);
	ob_look_fail_below(t);
}

static void observe_balls(ob_case_run_state *t)
{
	double energy = ob_look_energy(t);
	if (!t->frame)
		t->memory[0] = energy;
	double error = energy - t->memory[0];
	if (t->frame)
		t->figure[1] += (error * error - t->figure[1]) / t->frame; // mean over the frames
	ob_look_keep(&t->figure[0], fabs(error) / t->memory[0]);
}

static void judge_balls(ob_case_run_state *t)
{
	ob_look_fail_below(t);
}

// clang-format off
#define CROWD \
	.figures = HEAP_FIGURES, .observe = observe_heap, .judge = judge_crowd, \
	.figure = { { .name = "resting mean penetration", .unit = "mm" }, \
		    { .name = "resting worst penetration", .unit = "mm" }, \
		    { .name = "worst penetration at any moment", .unit = "mm" }, \
		    { .name = "growth of energy", .unit = "1" } }
// clang-format on

static const bench_scene families[] = {
	{ .of = { .name = "falling-", .duration = 10, .build = build_falling, CROWD } },
	{ .of = { .name = "cylinders-", .duration = 10, .build = build_cylinders, CROWD } },
	{ .of = { .name = "capsules-", .duration = 10, .build = build_capsules, CROWD } },
	{ .of = { .name = "sparse-", .duration = 10, .build = build_sparse, CROWD }, .sleeping = true },
	{ .of = { .name = "balls-",
		  .duration = 20,
		  .figures = 2,
		  .figure = { { .name = "error of energy", .unit = "1" },
			      { .name = "mean squared error of energy", .unit = "J^2" } },
		  .build = build_balls,
		  .observe = observe_balls,
		  .judge = judge_balls } },
};

const bench_scene *bench_scene_find(const char *name, ob_error *e)
{
	if (!ob_cases_open(NULL, 0, e))
		return NULL;
	const ob_case *c = ob_case_find(name);
	if (c) {
		scene = (bench_scene){ .of = *c };
		return &scene;
	}
	for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
		size_t n = strlen(families[i].of.name);
		char *end = "";
		long bodies = strncmp(name, families[i].of.name, n) ? 0 : strtol(name + n, &end, 10);
		if (bodies > 0 && bodies <= MOST && !*end) {
			scene = families[i];
			scene.bodies = (uint32_t)bodies;
			return &scene;
		}
	}
	ob_fail(e, "no scene \"%s\": a case of the lab, or falling-N, cylinders-N, capsules-N, sparse-N, balls-N",
		name);
	return NULL;
}
