// Hard cases that stand or fall: tall stacks, heavy on light, pyramids, a pile that drops, bricks that overhang.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

typedef struct outcome {
	double deepest, drift, sunk; // m: at any moment; the farthest that a body got aside; and down
	double deepest_end; // m
	double gained; // of the energy, at most
} outcome;

static outcome watch(little_scene *s, double seconds)
{
	outcome out = { 0 };
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	for (int step = 0; step < lround(60 * seconds); step++) {
		little_run(&l, 1);
		out.deepest = fmax(out.deepest, little_penetration(&l).max_m);
		out.gained = fmax(out.gained, little_energy(&l) / energy - 1);
	}
	for (uint32_t i = 0; i < s->objects; i++) {
		ob_vec3 moved = ob_sub(little_state(&l, i).pose.p, s->object[i].state.pose.p);
		out.drift = fmax(out.drift, hypot(moved.x, moved.y));
		out.sunk = fmax(out.sunk, -moved.z);
	}
	out.deepest_end = little_penetration(&l).max_m;
	little_close(&l);
	free(s);
	return out;
}

static void test_stack(int n, double drift)
{
	little_scene *s = little_scene_new();
	little_stack(s, n, 7);
	outcome o = watch(s, 20);
	printf("stack of %d: %.3f mm deep, drifts %.3f mm, energy gained %.1e\n", n, 1e3 * o.deepest, 1e3 * o.drift,
	       o.gained);
	CHECK(o.deepest <= .5e-3);
	CHECK(o.drift <= drift);
	CHECK(o.sunk <= n * .1e-3);
	CHECK(o.gained <= 1e-9);
}

// A heavy cube on a stack of n light ones
static void test_heavy_on_light(int n, double ratio, double deepest)
{
	little_scene *s = little_scene_new();
	little_stack(s, n, 7);
	little_box(s, ratio * 1000, ob_v3(.5, .5, .5), ob_v3(.005, .005, n + .5));
	outcome o = watch(s, 10);
	printf("%g:1 on %d: %.3f mm deep, drifts %.3f mm, energy gained %.1e\n", ratio, n, 1e3 * o.deepest,
	       1e3 * o.drift, o.gained);
	CHECK(o.deepest <= deepest);
	CHECK(o.sunk <= (n + 1) * deepest && o.drift <= 1e-3);
	CHECK(o.gained <= 1e-9);
}

// A stack that falls onto itself, each cube by a hundredth of its size, comes to rest where it lands.
static void test_rattled_stack(void)
{
	little_scene *s = little_scene_new();
	little_stack(s, 20, 7);
	for (uint32_t i = 1; i <= 20; i++)
		s->object[i].state.pose.p.z += .01 * i;
	outcome o = watch(s, 10);
	printf("rattled stack of 20: %.3f mm deep at the end, drifts %.3f mm\n", 1e3 * o.deepest_end, 1e3 * o.drift);
	CHECK(o.deepest_end <= .5e-3);
	CHECK(o.drift <= 10e-3);
}

static void test_pyramid(int rows)
{
	little_scene *s = little_scene_new();
	little_ground(s);
	for (int row = 0; row < rows; row++)
		for (int i = 0; i < rows - row; i++)
			little_box(s, 1000, ob_v3(.5, .5, .5), ob_v3(0, 1.05 * (i - .5 * (rows - row - 1)), .5 + row));
	outcome o = watch(s, 10);
	printf("pyramid of %d rows: %.3f mm deep, drifts %.3f mm\n", rows, 1e3 * o.deepest, 1e3 * o.drift);
	CHECK(o.deepest <= .5e-3);
	CHECK(o.drift <= 1e-3);
}

// 216 boxes of half a metre in a loose grid, slightly turned, drop half a metre.
static void test_pile(double e)
{
	uint64_t seed = 1;
	little_scene *s = little_scene_new();
	s->run.tolerance = 1e-3; // as the program's own settings have it
	little_ground(s);
	for (int i = 0; i < 216; i++) {
		ob_vec3 p = ob_v3((i % 6 - 2.5) * .75, (i / 6 % 6 - 2.5) * .75, .75 + .8 * (i / 36));
		ob_vec3 off = random_vector(&seed, .05), turn = random_vector(&seed, .15);
		little_object *o = little_box(s, 1, ob_v3(.25, .25, .25), ob_add(p, off));
		o->passport.restitution = e;
		o->state.pose.q = ob_quat_turn(ob_quat_identity(), turn);
	}
	outcome o = watch(s, 8);
	printf("pile, e = %g: %.3f mm deep at worst, %.3f mm at the end\n", e, 1e3 * o.deepest, 1e3 * o.deepest_end);
	CHECK(o.deepest <= 1e-3);
	CHECK(o.deepest_end <= 1e-3);
	CHECK(o.gained <= 1e-9);
}

// Four bricks over the edge of a table, each as far over the one below as balance allows, times a factor: 1.04 lengths
// together. Below 1 they stand, above they topple.
static double sunk(double factor)
{
	static const double over[] = { 1. / 8, 1. / 6, 1. / 4, 1. / 2 };
	little_scene *s = little_scene_new();
	little_box(s, 0, ob_v3(2, .5, .5), ob_v3(-2, 0, -.5));
	double x = -.5;
	for (int i = 0; i < 4; i++) {
		x += factor * over[i];
		little_box(s, 1, ob_v3(.5, .25, .1), ob_v3(x, 0, .1 + .2 * i));
	}
	return watch(s, 10).sunk;
}

int main(void)
{
	test_stack(20, 1e-3);
	test_stack(40, 10e-3);
	test_heavy_on_light(1, 100, .6e-3);
	test_heavy_on_light(1, 1000, 2e-3);
	test_heavy_on_light(10, 100, 2e-3);
	test_rattled_stack();
	test_pyramid(10);
	test_pyramid(15);
	test_pile(0);
	test_pile(.5);
	CHECK(sunk(.99) < 1e-3);
	CHECK(sunk(1.01) > 1);
	return check_end();
}
