#include "world/builders.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "elementary/elementary.h"
#include "hull/hull.h"
#include "shape/shape.h"

static void *grown(void *old, uint32_t count, size_t size)
{
	void *more = realloc(old, count * size);
	if (!more) {
		fprintf(stderr, "no memory for a world of %u bodies\n", count);
		abort();
	}
	return more;
}

void ob_world_kinematic(ob_world_body b)
{
	b.passport->flags = OB_OBJECT_PRESENT | OB_OBJECT_KINEMATIC;
	b.passport->mass = 0;
	b.passport->inertia = ob_v3(0, 0, 0);
}

void ob_world_swing(ob_world *w, ob_world_body b, ob_vec3 amplitude, double frequency, double phase)
{
	ob_world_kinematic(b);
	w->path = grown(w->path, w->paths + 1, sizeof *w->path);
	w->path[w->paths++] =
		(struct ob_world_path){ b.passport->id, ob_path_sine(b.state, amplitude, frequency, phase) };
}

// Number of the hull, which its parts follow; several bodies may share one.
static uint32_t add_hull(ob_world *w, const ob_hull *h)
{
	const uint32_t all = 1 + h->parts, number = w->hulls;
	for (uint32_t i = 0; i + all <= w->hulls; i++)
		if (!memcmp(&w->hull[i], h, all * sizeof *h))
			return i;
	w->hull = grown(w->hull, w->hulls + all, sizeof *w->hull);
	memcpy(w->hull + number, h, all * sizeof *h);
	w->hulls += all;
	return number;
}

static ob_world_body add_hulled(ob_world *w, double mass, const ob_hull *h, ob_vec3 p)
{
	ob_world_body b = ob_world_add(w, OB_SHAPE_HULL, ob_hull_size(h), mass, ob_add(p, h->centre));
	b.passport->hull = (uint16_t)add_hull(w, h);
	b.passport->inertia = ob_scale(h->inertia, mass);
	b.state->pose.q = h->frame;
	return b;
}

ob_world_body ob_world_hull(ob_world *w, double mass, const ob_vec3 *point, uint32_t points, ob_vec3 p)
{
	ob_hull h;
	ob_error e;
	if (!ob_hull_build(point, points, &h, &e)) {
		fprintf(stderr, "hull: %s\n", e.text);
		abort();
	}
	return add_hulled(w, mass, &h, p);
}

ob_world_body ob_world_compound(ob_world *w, double mass, const ob_hull_part *part, uint32_t parts, ob_vec3 p)
{
	ob_hull *h = grown(NULL, 1 + parts, sizeof *h);
	uint32_t failed;
	ob_error e;
	if (!ob_hull_build_compound(part, parts, ob_v3(NAN, NAN, NAN), h, &failed, &e)) {
		fprintf(stderr, "compound: %s\n", e.text);
		abort();
	}
	const ob_world_body b = add_hulled(w, mass, h, p);
	free(h);
	return b;
}

ob_world_body ob_world_terrain(ob_world *w, ob_terrain *t, ob_vec3 p)
{
	const uint32_t number = w->terrains ? (uint32_t)w->terrains->count : 0;
	ob_error e = { "there is none" };
	if (!t || !ob_terrain_set_add(&w->terrains, t, &e)) {
		fprintf(stderr, "terrain: %s\n", e.text);
		abort();
	}
	const ob_world_body b = ob_world_add(w, OB_SHAPE_TERRAIN, ob_terrain_size(t), 0, p);
	b.passport->hull = (uint16_t)number;
	free(t);
	return b;
}

ob_world_body ob_world_slope(ob_world *w, double angle)
{
	ob_world_body b = ob_world_ground(w);
	b.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	return b;
}

void ob_world_stack(ob_world *w, int n, ob_vec3 foot, uint64_t seed)
{
	for (int i = 0; i < n; i++) {
		double x = ob_splitmix_within(&seed, -.01, .01), y = ob_splitmix_within(&seed, -.01, .01);
		ob_world_box(w, 1000, ob_v3(.5, .5, .5), ob_add(foot, ob_v3(x, y, .5 + i)));
	}
}

// Size with the volume of a box of these half extents: a cylinder of the same height, or a capsule twice as long as
// thick.
static ob_vec3 size_of_volume(ob_shape shape, ob_vec3 half)
{
	const double radius = ob_pow(8 * half.x * half.y * half.z / (10. / 3 * M_PI), 1. / 3);
	if (shape == OB_SHAPE_CYLINDER)
		return ob_v3(sqrt(4 * half.x * half.y / M_PI), half.z, 0);
	return shape == OB_SHAPE_CAPSULE ? ob_v3(radius, radius, 0) : half;
}

static ob_world_body solid_of_any_size(ob_world *w, ob_shape shape, ob_vec3 p, uint64_t *seed)
{
	ob_vec3 half = ob_add(ob_v3(.3, .3, .3), ob_splitmix_vector(seed, .2));
	ob_world_body b = ob_world_add(w, shape, size_of_volume(shape, half), 8000 * half.x * half.y * half.z, p);
	b.state->pose.q = ob_world_random_attitude(seed);
	return b;
}

// Side of the square that holds n bodies.
static uint32_t side_of(uint32_t n)
{
	return (uint32_t)ceil(sqrt(n));
}

void ob_world_falling(ob_world *w, uint32_t n, uint64_t seed)
{
	ob_world_falling_solids(w, OB_SHAPE_BOX, n, seed);
}

void ob_world_falling_solids(ob_world *w, ob_shape shape, uint32_t n, uint64_t seed)
{
	enum { LEVELS = 4 };
	uint32_t side = side_of((n + LEVELS - 1) / LEVELS);
	double z = 0;
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t column = i / LEVELS;
		z = (i % LEVELS ? z : 1) + 1.8 + ob_splitmix_real(&seed);
		solid_of_any_size(w, shape, ob_v3(1.8 * (column % side), 1.8 * (column / side), z), &seed);
	}
}

void ob_world_sparse(ob_world *w, uint32_t n, uint64_t seed)
{
	uint32_t side = side_of(n);
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++) {
		ob_vec3 p = ob_v3(4. * (i % side), 4. * (i / side), ob_splitmix_within(&seed, 2, 10));
		ob_world_body b = solid_of_any_size(w, OB_SHAPE_BOX, p, &seed);
		b.state->v = ob_splitmix_vector(&seed, 1);
		b.state->v.z = ob_splitmix_within(&seed, 0, 4);
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(w, .5, .8);
}

void ob_world_balls(ob_world *w, uint32_t n)
{
	uint32_t side = side_of(n);
	ob_world_ground(w);
	for (uint32_t i = 0; i < n; i++)
		ob_world_sphere(w, 10, .1, ob_v3(2. * (i % side), 2. * (i / side), 5));
	ob_world_material(w, 0, 1);
}

ob_quat ob_world_random_attitude(uint64_t *seed)
{
	double w = ob_splitmix_within(seed, -1, 1);
	ob_vec3 v = ob_splitmix_vector(seed, 1);
	return ob_quat_normalize((ob_quat){ w, v.x, v.y, v.z });
}
