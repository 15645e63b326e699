// Impacts beyond the cases of the lab: one that runs through a row of spheres, flat boxes that bounce on their edges,
// boxes that hit each other at high speed.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

// Balls with a centimetre between them: the impact of the first runs through all of them within a step.
static void test_spaced_row(double speed)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 8; i++) {
		ob_world_body o = ob_world_sphere(&s->world, 1, .1, ob_v3(.21 * i, 0, 0));
		o.passport->restitution = 1;
		o.state->v.x = i ? 0 : speed;
	}
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 60; step++) {
		little_run(&l, 1);
		CHECK_NEAR(little_penetration(&l).max_m, 0, 1e-9);
	}
	for (uint32_t i = 0; i < 8; i++)
		CHECK_NEAR(little_state(&l, i).v.x, i == 7 ? speed : 0, 1e-9);
	little_close(&l);
	free(s);
}

// A flat box that bounces on its edges and corners turns from each to the next and keeps its energy, or loses some to
// friction and where it comes to lie.
static void test_flat_box(double friction, double tilt)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_body o = ob_world_box(&s->world, 1, ob_v3(.5, .5, .05), ob_v3(0, 0, 1.05));
	o.passport->restitution = 1;
	o.passport->friction = friction;
	o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(tilt, .02, 0));
	little_universe l;
	little_open(&l, s);
	double before = little_energy(&l), most = 0, deepest = 0;
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		most = fmax(most, little_energy(&l) / before - 1);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	CHECK(most <= 1e-9);
	CHECK(deepest <= 1e-3);
	if (friction == 0)
		CHECK(little_energy(&l) >= .9 * before);
	little_close(&l);
	free(s);
}

typedef struct collision {
	bool slower; // they hit
	bool sides; // they have changed sides
	double gained; // energy, relative
} collision;

// Two boxes, up to 5 cm off the line on which they meet.
static collision collide(uint64_t *seed, double speed, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.substeps = substeps;
	for (int i = 0; i < 2; i++) {
		double side = i ? 1 : -1, x = within(seed, 3, 4), y = within(seed, -.025, .025);
		ob_world_body o = ob_world_box(&s->world, 1, ob_v3(.1, .1, .1), ob_v3(side * x, y, within(seed, -.025, .025)));
		o.passport->friction = .3;
		o.state->pose.q = random_attitude(seed);
		o.state->w = random_vector(seed, 1);
		o.state->v.x = -side * speed;
	}
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	little_run(&l, 3 + (uint64_t)(60 * 5 / speed));
	ob_state a = little_state(&l, 0), b = little_state(&l, 1);
	collision out = { a.v.x - b.v.x<speed, a.pose.p.x> b.pose.p.x, little_energy(&l) / energy - 1 };
	little_close(&l);
	free(s);
	return out;
}

// Some corners slip past each other, and the two fly on as they turn round each other; whether they do is known from
// runs that are made in a hundred times as many substeps.
static void test_collisions(double speed, int aims)
{
	uint64_t seed = 19;
	int hit = 0, passed = 0, slipped = 0;
	for (int k = 0; k < aims; k++) {
		uint64_t same = seed;
		collision x = collide(&seed, speed, 8), fine = collide(&same, speed, 4000);
		hit += x.slower;
		slipped += fine.sides;
		passed += x.sides && !fine.sides;
		CHECK(x.gained <= 1e-9);
	}
	printf("+-%g m/s: %d of %d hit, %d passed, %d slipped past each other as they should\n", speed, hit, aims,
	       passed, slipped);
	CHECK(hit == aims);
	CHECK(passed == 0);
	CHECK(slipped <= aims / 5);
}

int main(void)
{
	test_spaced_row(4);
	test_spaced_row(10);
	test_spaced_row(40);
	test_flat_box(0, .2);
	test_flat_box(.5, .2);
	test_flat_box(.5, .001);
	test_collisions(200, 100);
	test_collisions(500, 100);
	test_collisions(1000, 100);
	return check_end();
}
