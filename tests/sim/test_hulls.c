// Hulls: a box that is given as a hull of its corners moves as the box does; heaps of hulls rest, as deep in each other
// as boxes are; momentum and energy.
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "check.h"
#include "hull/solids.h"
#include "little_universe.h"

// A cuboid, as a box or as a hull of its corners.
static ob_world_body cuboid(little_scene *s, bool hull, double mass, ob_vec3 half, ob_vec3 p)
{
	ob_vec3 corner[8];
	for (int k = 0; k < 8; k++)
		corner[k] = ob_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
	return hull ? ob_world_hull(&s->world, mass, corner, 8, p) : ob_world_box(&s->world, mass, half, p);
}

typedef void build(little_scene *s, bool hull);

static void throw_one(little_scene *s, bool hull)
{
	ob_world_ground(&s->world);
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .4), ob_v3(0, 0, 2));
	b.state->v = ob_v3(2, .5, 0);
	b.state->w = ob_v3(3, -2, 1);
	b.passport->restitution = .3;
}

// On a table, and on what stands there: no planes.
static void tumble_on_boxes(little_scene *s, bool hull)
{
	cuboid(s, hull, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	cuboid(s, hull, 0, ob_v3(.5, .5, .2), ob_v3(.9, .1, .2));
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .4), ob_v3(0, 0, 2));
	b.state->v = ob_v3(1.2, .1, 0);
	b.state->w = ob_v3(1, -2, .5);
}

static void push_one(little_scene *s, bool hull)
{
	ob_world_ground(&s->world);
	cuboid(s, false, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.4)); // a table of its own: a face, not a plane
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .1), ob_v3(-2, 0, .2));
	b.state->v = ob_v3(4, .3, 0);
	b.state->w = ob_v3(0, 0, 2);
}

static void push_over_hull(little_scene *s, bool hull)
{
	cuboid(s, hull, 0, ob_v3(5, 5, .5), ob_v3(0, 0, -.5));
	ob_world_body b = cuboid(s, hull, 12, ob_v3(.3, .2, .1), ob_v3(-2, 0, .1));
	b.state->v = ob_v3(4, .3, 0);
}

static void stack_ten(little_scene *s, bool hull)
{
	uint64_t seed = 5;
	ob_world_ground(&s->world);
	for (int i = 0; i < 10; i++) {
		const double x = ob_splitmix_within(&seed, -.01, .01), y = ob_splitmix_within(&seed, -.01, .01);
		cuboid(s, hull, 1000, ob_v3(.5, .5, .5), ob_v3(x, y, .5 + i));
	}
}

static void finish(little_universe *l, little_scene *s)
{
	little_close(l);
	free(s->world.hull);
	free(s);
}

static double difference(build *scene, double time, int *objects)
{
	double most = 0;
	little_scene *s[2];
	little_universe u[2];
	for (int k = 0; k < 2; k++) {
		s[k] = little_scene_new();
		s[k]->run.tolerance = .001;
		scene(s[k], k);
		little_open(&u[k], s[k]);
	}
	*objects = (int)s[0]->world.objects;
	for (double t = .1; t <= time; t += .1) {
		double now = 0;
		for (int k = 0; k < 2; k++)
			little_run_to(&u[k], t);
		for (int id = 0; id < *objects; id++) {
			const ob_state a = little_state(&u[0], (uint32_t)id), b = little_state(&u[1], (uint32_t)id);
			const ob_mat3 ra = ob_quat_matrix(a.pose.q), rb = ob_quat_matrix(b.pose.q);
			now = fmax(now, ob_norm(ob_sub(a.pose.p, b.pose.p)));
			for (int i = 0; i < 3; i++) // of points a metre from the centre
				now = fmax(now, ob_norm(ob_sub(ob_column(&ra, i), ob_column(&rb, i))));
		}
		most = fmax(most, now);
	}
	for (int k = 0; k < 2; k++)
		finish(&u[k], s[k]);
	return most;
}

static void boxes_as_hulls(void)
{
	int n;
	const struct {
		const char *name;
		build *scene;
		double time;
	} each[] = { { "tumble", throw_one, 3 },
		     { "tumble on boxes", tumble_on_boxes, 3 },
		     { "slide", push_one, 3 },
		     { "slide on a hull", push_over_hull, 3 },
		     { "stack of 10", stack_ten, 5 } };
	for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
		const double d = difference(each[i].scene, each[i].time, &n);
		printf("%s: %.3g m\n", each[i].name, d);
		CHECK(d <= 1e-9);
	}
}

// The hull of so many points on an ellipsoid.
static ob_world_body pebble(little_scene *s, uint64_t *seed, int points, ob_vec3 p)
{
	ob_vec3 point[16];
	const ob_vec3 half = ob_add(ob_v3(.4, .4, .4), ob_splitmix_vector(seed, .2));
	for (int k = 0; k < points; k++) {
		ob_vec3 d = ob_splitmix_vector(seed, 1);
		d = ob_scale(d, 1 / ob_norm(d));
		point[k] = ob_v3(half.x * d.x, half.y * d.y, half.z * d.z);
	}
	ob_world_body b = ob_world_hull(&s->world, 500, point, (uint32_t)points, p);
	b.state->pose.q = ob_world_random_attitude(seed);
	return b;
}

// Nothing is deeper in another than the tolerance, energy does not rise, and in the end all lies still.
static void heap(void)
{
	enum { PEBBLES = 48 };
	uint64_t seed = 11;
	little_scene *s = little_scene_new();
	little_universe l;
	s->run.tolerance = .001;
	ob_world_ground(&s->world);
	for (int i = 0; i < PEBBLES; i++)
		pebble(s, &seed, 8 + i % 9, ob_v3(1.25 * (i % 4), 1.25 * (i / 4 % 4), 1 + 1.3 * (i / 16)));
	little_open(&l, s);
	double deepest = 0, energy = little_energy(&l), fastest = 0;
	for (int step = 0; step < 300; step += 10) {
		little_run(&l, 10);
		const double now = little_energy(&l);
		deepest = fmax(deepest, little_penetration(&l).max_m);
		CHECK(now <= energy + 1e-6 * fabs(energy));
		energy = now;
	}
	for (uint32_t id = 1; id <= PEBBLES; id++)
		fastest = fmax(fastest, ob_norm(little_state(&l, id).v));
	printf("heap: %.3g mm deep, %.3g m/s in the end\n", 1e3 * deepest, fastest);
	CHECK(deepest > 0 && deepest <= 1e-3);
	CHECK(fastest < .05);
	finish(&l, s);
}

// Elastic hulls without friction that fly through each other's midst: momentum, angular momentum and energy stay.
static void swarm(void)
{
	enum { BODIES = 10 };
	uint64_t seed = 4;
	little_scene *s = little_scene_new();
	little_universe l;
	s->run.gravity = s->world.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = .001;
	for (int i = 0; i < BODIES; i++) {
		const ob_vec3 from = ob_scale(ob_v3(cos(2.4 * i), sin(2.4 * i), .6 * (i % 3 - 1)), 1.6 + .35 * i);
		ob_world_body b = pebble(s, &seed, 10, from);
		b.state->v = ob_scale(from, -1. / ob_norm(from));
		b.state->w = ob_splitmix_vector(&seed, 1);
	}
	ob_world_material(&s->world, 0, 1);
	little_open(&l, s);
	const double energy = little_energy(&l);
	const ob_vec3 p = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	ob_state before[BODIES];
	int turned = 0;
	for (uint32_t i = 0; i < BODIES; i++)
		before[i] = little_state(&l, i);
	little_run(&l, 240);
	for (uint32_t i = 0; i < BODIES; i++)
		turned += ob_norm(ob_sub(little_state(&l, i).v, before[i].v)) > .1;
	CHECK(turned >= BODIES / 2);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-9);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_momentum(&l.now), p)), 0, 1e-9 * 500 * BODIES);
	CHECK_NEAR(ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), spin)), 0, 1e-9 * 500 * 5 * BODIES);
	CHECK(little_penetration(&l).max_m <= 1e-3);
	finish(&l, s);
}

int main(void)
{
	boxes_as_hulls();
	heap();
	swarm();
	return check_end();
}
