// Objects that are hit within a step and hit another in the same step: no forecast includes it, the check for late
// contacts finds it.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"
#include "step/state.h"

static ob_counters counted(const little_universe *l)
{
	ob_counters sum;
	ob_universe_count(l->u, &sum);
	return sum;
}

// A bullet hits the first of a row of spheres, each 1 cm from the next: the push runs through all within one step.
static void test_row(void)
{
	enum { SPHERES = 8 };
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	ob_world_sphere(&s->world, 1, .1, ob_v3(-3, 0, 0)).state->v = ob_v3(100, 0, 0);
	for (int i = 0; i < SPHERES; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(.21 * i, 0, 0));
	for (uint32_t i = 0; i < s->world.objects; i++)
		s->world.passport[i].restitution = 1;
	little_universe l;
	little_open(&l, s);
	little_run(&l, 6);
	CHECK(counted(&l).island_merges > 0);
	for (uint32_t i = 0; i < SPHERES; i++)
		CHECK_NEAR(little_state(&l, i).v.x, 0, 1e-9);
	CHECK_NEAR(little_state(&l, SPHERES).v.x, 100, 1e-9);
	CHECK(little_penetration(&l).max_m < 1e-9);
	little_close(&l);
	free(s);
}

// Sleepers hit by a body that was itself hit wake up and take part in the same step.
static void test_sleepers(void)
{
	little_scene *s = little_scene_new();
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	for (int i = 0; i < 4; i++)
		ob_world_sphere(&s->world, 1, .1, ob_v3(.21 * i, 0, .1)).passport->friction = 0;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 2);
	CHECK(little_asleep(&l, 1) && little_asleep(&l, 4));
	s->world.state[1].pose.p = ob_v3(-3, 0, .1);
	s->world.state[1].v = ob_v3(60, 0, 0);
	little_take_away(&l, 1);
	little_put(&l, 1);
	little_run(&l, 6);
	double momentum = 0;
	for (uint32_t i = 1; i <= 4; i++)
		momentum += little_state(&l, i).v.x;
	CHECK(!little_asleep(&l, 4) && little_state(&l, 4).v.x > 1);
	CHECK_NEAR(momentum, 60, 1e-6);
	CHECK(counted(&l).island_merges > 0);
	little_close(&l);
	free(s);
}

// Clouds of fast boxes and spheres in a narrow room: no body passes through another, momentum and energy are kept.
static void test_clouds(void)
{
	uint64_t merges = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		uint64_t random = seed;
		little_scene *s = little_scene_new();
		s->run.gravity = ob_v3(0, 0, 0);
		for (int i = 0; i < 27; i++) {
			ob_vec3 p = ob_v3(.5 * (i % 3) - .5, .5 * (i / 3 % 3) - .5, .5 * (i / 9) - .5);
			ob_world_body o = i % 2 ? ob_world_sphere(&s->world, 1, .12, p)
						: ob_world_box(&s->world, 1, ob_v3(.12, .1, .08), p);
			o.state->v = ob_scale(ob_v3(-p.x, -p.y, -p.z), within(&random, 10, 40));
			o.state->w = ob_v3(within(&random, -9, 9), within(&random, -9, 9), within(&random, -9, 9));
			o.passport->friction = .3;
			o.passport->restitution = .3;
		}
		little_universe l;
		little_open(&l, s);
		little_run(&l, 0);
		double energy = little_energy(&l), worst = 0;
		ob_vec3 before = ob_measure_momentum(&l.now);
		for (int step = 0; step < 30; step++) {
			little_run(&l, 1);
			worst = fmax(worst, little_penetration(&l).max_m);
			CHECK(little_energy(&l) <= energy * (1 + 1e-6));
			energy = little_energy(&l);
		}
		CHECK(worst < .01);
		CHECK(ob_norm(ob_sub(ob_measure_momentum(&l.now), before)) < 1e-8);
		merges += counted(&l).island_merges;
		little_close(&l);
		free(s);
	}
	CHECK(merges > 20);
}

// Balls of very different masses in a room: a light one is thrown to and fro between heavy ones within a step. Islands
// that a late contact joins are solved again, so what a check had found of the first solution is void: none gets deep.
static void test_mixed_masses(void)
{
	enum { SIDE = 4, BALLS = 60 };
	const double half = .45 * SIDE;
	double worst = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		uint64_t random = seed;
		little_scene *s = little_scene_new();
		s->run.gravity = ob_v3(0, 0, 0);
		for (int wall = 0; wall < 6; wall++) {
			ob_vec3 n = ob_v3(wall / 2 == 0, wall / 2 == 1, wall / 2 == 2);
			n = ob_scale(n, wall % 2 ? -1 : 1);
			ob_world_body o = ob_world_ground(&s->world);
			o.state->pose.p = ob_scale(n, -half);
			o.state->pose.q = ob_quat_turn(ob_quat_identity(),
						       n.z < 0 ? ob_v3(M_PI, 0, 0)
							       : ob_scale(ob_cross(ob_v3(0, 0, 1), n), M_PI / 2));
		}
		for (int i = 0; i < BALLS; i++) {
			const double radius = within(&random, .1, .3),
				     at[3] = { i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE };
			ob_vec3 p = ob_scale(ob_v3(at[0] - 1.5, at[1] - 1.5, at[2] - 1.5), .8);
			ob_world_body o =
				ob_world_sphere(&s->world, 40 * pow(10, i % 5) * radius * radius * radius, radius, p);
			o.state->v = random_vector(&random, 4);
			o.passport->friction = .2;
			o.passport->restitution = 1;
		}
		little_universe l;
		little_open(&l, s);
		for (int step = 0; step < 60; step++) {
			little_run(&l, 1);
			worst = fmax(worst, little_penetration(&l).max_m);
		}
		little_close(&l);
		free(s);
	}
	printf("balls of mixed masses: %g m deep at most\n", worst);
	CHECK(worst < 1e-3);
}

int main(void)
{
	test_row();
	test_sleepers();
	test_clouds();
	test_mixed_masses();
	return check_end();
}
