#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "world/builders.h"

enum { MOST = 1000000 }; // bodies

static bench_scene scene;

// ---- worlds of any number of bodies

static void build_falling(ob_world *w, uint32_t bodies)
{
	ob_world_falling(w, bodies, 100);
}

static void build_cylinders(ob_world *w, uint32_t bodies)
{
	ob_world_falling_solids(w, OB_SHAPE_CYLINDER, bodies, 100);
}

static void build_capsules(ob_world *w, uint32_t bodies)
{
	ob_world_falling_solids(w, OB_SHAPE_CAPSULE, bodies, 100);
}

static void build_sparse(ob_world *w, uint32_t bodies)
{
	ob_world_sparse(w, bodies, 200);
}

static const bench_scene families[] = {
	{ .of = { .name = "falling-", .duration = 10 }, .build = build_falling },
	{ .of = { .name = "cylinders-", .duration = 10 }, .build = build_cylinders },
	{ .of = { .name = "capsules-", .duration = 10 }, .build = build_capsules },
	{ .of = { .name = "sparse-", .duration = 10 }, .build = build_sparse, .sleeping = true },
	{ .of = { .name = "balls-", .duration = 20 }, .build = ob_world_balls, .elastic = true },
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
