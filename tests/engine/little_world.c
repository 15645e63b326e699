#include "little_world.h"

#include <stdio.h>
#include <stdlib.h>

static void give_up(const char *what, const char *why)
{
	fprintf(stderr, "%s: %s\n", what, why);
	exit(1);
}

little_world *little_world_new(void)
{
	little_world *l = calloc(1, sizeof *l);
	if (!l)
		give_up("world", "no memory");
	l->world.gravity = ob_v3(0, 0, -OB_WORLD_GRAVITY);
	return l;
}

void little_world_free(little_world *l)
{
	ob_world_finish(&l->world);
	free(l);
}

uint32_t little_add(little_world *l, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p)
{
	if (l->world.objects == LITTLE_MOST)
		give_up("world", "too many objects");
	return ob_world_add(&l->world, shape, size, mass, p).passport->id;
}

uint32_t little_ground(little_world *l)
{
	return little_add(l, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_v3(0, 0, 0));
}

uint32_t little_cube(little_world *l, double mass, double half, ob_vec3 p)
{
	return little_add(l, OB_SHAPE_BOX, ob_v3(half, half, half), mass, p);
}

uint32_t little_sphere(little_world *l, double mass, double radius, ob_vec3 p)
{
	return little_add(l, OB_SHAPE_SPHERE, ob_v3(radius, 0, 0), mass, p);
}

ob_engine *little_make(const ob_engine_kind *kind, const little_world *l, uint32_t substeps)
{
	ob_error e;
	ob_run_settings s = kind->usual;
	if (substeps)
		s.substeps = substeps;
	ob_engine *p = kind->create(&l->world, &s, &e);
	if (!p)
		give_up(kind->name, e.text);
	return p;
}

void little_step(const ob_engine_kind *kind, ob_engine *p, little_world *l, double seconds)
{
	ob_error e;
	long frames = lround(seconds / kind->usual.step_length);
	for (long i = 0; i < frames; i++)
		if (!kind->step(p, &e))
			give_up(kind->name, e.text);
	kind->get(p, l->now);
}

void little_run(const ob_engine_kind *kind, little_world *l, uint32_t substeps, double seconds)
{
	ob_engine *p = little_make(kind, l, substeps);
	little_step(kind, p, l, seconds);
	kind->destroy(p);
}
