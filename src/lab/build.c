#include "lab/build.h"

#include <stdio.h>
#include <stdlib.h>

static void *grown(void *old, uint32_t count, size_t size)
{
	void *more = realloc(old, count * size);
	if (!more) {
		fprintf(stderr, "no memory for a world of %u bodies\n", count);
		abort();
	}
	return more;
}

static ob_build_body add(ob_engine_world *w, ob_shape shape, ob_vec3 size, double mass, ob_vec3 p)
{
	if (w->objects == w->objects_max) {
		w->objects_max = w->objects_max ? 2 * w->objects_max : 16;
		w->passport = grown(w->passport, w->objects_max, sizeof *w->passport);
		w->state = grown(w->state, w->objects_max, sizeof *w->state);
	}
	uint32_t id = w->objects++;
	w->passport[id] = (ob_passport){ .id = id, .generation = 1, .shape = shape, .size = size, .mass = mass };
	w->passport[id].flags = OB_OBJECT_PRESENT | (mass > 0 ? 0 : OB_OBJECT_STATIC);
	w->passport[id].friction = .5;
	w->state[id] = (ob_state){ .pose = { p, ob_quat_identity() } };
	return (ob_build_body){ &w->passport[id], &w->state[id] };
}

ob_build_body ob_build_box(ob_engine_world *w, double mass, ob_vec3 half, ob_vec3 p)
{
	ob_build_body b = add(w, OB_SHAPE_BOX, half, mass, p);
	double x = half.x * half.x, y = half.y * half.y, z = half.z * half.z;
	b.passport->inertia = ob_scale(ob_v3(y + z, z + x, x + y), mass / 3);
	return b;
}

ob_build_body ob_build_sphere(ob_engine_world *w, double mass, double radius, ob_vec3 p)
{
	ob_build_body b = add(w, OB_SHAPE_SPHERE, ob_v3(radius, 0, 0), mass, p);
	double i = .4 * mass * radius * radius;
	b.passport->inertia = ob_v3(i, i, i);
	return b;
}

ob_build_body ob_build_ground(ob_engine_world *w)
{
	return add(w, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_v3(0, 0, 0));
}

ob_build_body ob_build_slope(ob_engine_world *w, double angle)
{
	ob_build_body b = ob_build_ground(w);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	return b;
}

void ob_build_stack(ob_engine_world *w, int n, ob_vec3 foot, uint64_t seed)
{
	for (int i = 0; i < n; i++) {
		double x = ob_build_within(&seed, -.01, .01), y = ob_build_within(&seed, -.01, .01);
		ob_build_box(w, 1000, ob_v3(.5, .5, .5), ob_add(foot, ob_v3(x, y, .5 + i)));
	}
}

static ob_build_body box_of_any_size(ob_engine_world *w, ob_vec3 p, uint64_t *seed)
{
	ob_vec3 half = ob_add(ob_v3(.3, .3, .3), ob_build_vector(seed, .2));
	ob_build_body b = ob_build_box(w, 8000 * half.x * half.y * half.z, half, p);
	b.state->pose.q = ob_build_attitude(seed);
	return b;
}

// The side of the square that n stand in
static uint32_t side_of(uint32_t n)
{
	return (uint32_t)ceil(sqrt(n));
}

void ob_build_falling(ob_engine_world *w, uint32_t n, uint64_t seed)
{
	enum { LEVELS = 4 };
	uint32_t side = side_of((n + LEVELS - 1) / LEVELS);
	double z = 0;
	ob_build_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t column = i / LEVELS;
		z = (i % LEVELS ? z : 1) + 1.8 + ob_build_uniform(&seed);
		box_of_any_size(w, ob_v3(1.8 * (column % side), 1.8 * (column / side), z), &seed);
	}
}

void ob_build_sparse(ob_engine_world *w, uint32_t n, uint64_t seed)
{
	uint32_t side = side_of(n);
	ob_build_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		ob_vec3 p = ob_v3(4. * (i % side), 4. * (i / side), ob_build_within(&seed, 2, 10));
		ob_build_body b = box_of_any_size(w, p, &seed);
		b.state->v = ob_build_vector(&seed, 1);
		b.state->v.z = ob_build_within(&seed, 0, 4);
		b.state->w = ob_build_vector(&seed, 1);
	}
	ob_build_material(w, .5, .8);
}

void ob_build_balls(ob_engine_world *w, uint32_t n)
{
	uint32_t side = side_of(n);
	ob_build_ground(w);
	for (uint32_t i = 0; i < n; i++)
		ob_build_sphere(w, 10, .1, ob_v3(2. * (i % side), 2. * (i / side), 5));
	ob_build_material(w, 0, 1);
}

void ob_build_material(ob_engine_world *w, double friction, double restitution)
{
	for (uint32_t i = 0; i < w->objects; i++) {
		w->passport[i].friction = friction;
		w->passport[i].restitution = restitution;
	}
}

void ob_build_finish(ob_engine_world *w)
{
	free(w->passport);
	free(w->state);
	*w = (ob_engine_world){ 0 };
}

double ob_build_uniform(uint64_t *seed)
{
	uint64_t z = *seed += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

double ob_build_within(uint64_t *seed, double low, double high)
{
	return low + (high - low) * ob_build_uniform(seed);
}

ob_vec3 ob_build_vector(uint64_t *seed, double size)
{
	double x = ob_build_within(seed, -size, size), y = ob_build_within(seed, -size, size);
	return ob_v3(x, y, ob_build_within(seed, -size, size));
}

ob_quat ob_build_attitude(uint64_t *seed)
{
	double w = ob_build_within(seed, -1, 1);
	ob_vec3 v = ob_build_vector(seed, 1);
	return ob_quat_normalize((ob_quat){ w, v.x, v.y, v.z });
}
