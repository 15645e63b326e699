// Bodies that hit each other in the air: as exactly as their flights, and without a substep.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "motion/random.h"

// Two bodies thrown at each other, rotating; over a floor, from which they may bounce.
static little_scene *thrown(uint64_t *seed, double e, bool floor)
{
	little_scene *s = little_scene_new();
	if (floor)
		ob_world_ground(&s->world);
	for (int i = 0; i < 2; i++) {
		double a = within(seed, .1, .4), b = within(seed, .1, .4), c = within(seed, .1, .4);
		const ob_vec3 p = ob_v3(i ? 1 : -1, 0, 1.5);
		const bool ball = uniform(seed) < .2;
		ob_world_body o = ball ? ob_world_sphere(&s->world, 1 + a, a, p)
				       : ob_world_box(&s->world, 1 + b, ob_v3(a, b, c), p);
		o.passport->restitution = e;
		o.passport->friction = within(seed, 0, 1);
		o.state->v = ob_add(ob_v3(i ? -4 : 4, 0, 2), random_vector(seed, .5));
		o.state->w = random_vector(seed, 6);
		o.state->pose.q = random_attitude(seed);
	}
	return s;
}

typedef struct outcome {
	double energy, momentum, spin, deepest; // relative errors; m
	uint64_t hits, solved; // solved: islands, by the contact solver
} outcome;

static double apart(ob_vec3 a, ob_vec3 b)
{
	return ob_norm(ob_sub(a, b)) / ob_norm(a);
}

static outcome play(little_scene *s, int steps)
{
	little_universe l;
	outcome out = { 0 };
	ob_counters c;
	little_open(&l, s);
	little_run(&l, 0);
	const double energy = little_energy(&l);
	const ob_vec3 momentum = ob_measure_momentum(&l.now), spin = ob_measure_angular_momentum(&l.now);
	for (int k = 0; k < steps; k++) {
		little_run(&l, 1);
		out.energy = fmax(out.energy, fabs(little_energy(&l) / energy - 1));
		out.momentum = fmax(out.momentum, apart(momentum, ob_measure_momentum(&l.now)));
		out.spin = fmax(out.spin, apart(spin, ob_measure_angular_momentum(&l.now)));
		out.deepest = fmax(out.deepest, little_penetration(&l).max_m);
	}
	ob_universe_count(l.u, &c);
	out.hits = c.impacts;
	out.solved = c.island_steps;
	little_close(&l);
	free(s);
	return out;
}

// Nothing else acts: momentum, angular momentum and energy are conserved. Low rebounds may rattle: the contact solver
// has those.
static void test_in_space(bool elastic)
{
	uint64_t seed = 1, hits = 0, solved = 0;
	outcome worst = { 0 };
	for (int k = 0; k < 200; k++) {
		little_scene *s = thrown(&seed, elastic ? 1 : within(&seed, .1, .9), false);
		s->run.gravity = ob_v3(0, 0, 0);
		for (uint32_t i = 0; i < 2 && elastic; i++)
			s->world.passport[i].friction = 0;
		const outcome o = play(s, 45);
		hits += o.hits, solved += o.solved;
		worst.energy = fmax(worst.energy, o.energy);
		worst.momentum = fmax(worst.momentum, o.momentum);
		worst.spin = fmax(worst.spin, o.spin);
		worst.deepest = fmax(worst.deepest, o.deepest);
	}
	printf("%lu hits in space, %lu steps by the contact solver; energy %.1e, momentum %.1e, spin %.1e, depth %.1e "
	       "m\n",
	       (unsigned long)hits, (unsigned long)solved, worst.energy, worst.momentum, worst.spin, worst.deepest);
	CHECK(hits > 150);
	CHECK(worst.momentum < 1e-13);
	CHECK(worst.spin < 1e-12);
	CHECK(!elastic || worst.energy < 1e-13);
	CHECK(!elastic || worst.deepest < 1e-12);
	CHECK(solved * (elastic ? 50 : 10) < hits);
}

// While they fall, and bounce off the floor.
static void test_falling(void)
{
	uint64_t seed = 2, hits = 0, solved = 0;
	double energy = 0, deepest = 0;
	for (int k = 0; k < 300; k++) {
		little_scene *s = thrown(&seed, 1, true);
		for (uint32_t i = 0; i < s->world.objects; i++)
			s->world.passport[i].friction = 0;
		const outcome o = play(s, 60);
		hits += o.hits, solved += o.solved;
		energy = fmax(energy, o.energy);
		deepest = fmax(deepest, o.deepest);
	}
	printf("%lu hits over a floor, %lu steps by the contact solver; energy %.1e, depth %.1e m\n",
	       (unsigned long)hits, (unsigned long)solved, energy, deepest);
	CHECK(hits > 600);
	CHECK(solved * 50 < hits);
	CHECK(energy < 1e-12);
	CHECK(deepest < 1e-9);
}

// Balls without friction keep their rotation in any hit.
static void test_attitudes(void)
{
	little_scene *s = little_scene_new();
	little_universe l;
	ob_world_ground(&s->world);
	for (int i = 0; i < 2; i++) {
		ob_world_body o = ob_world_sphere(&s->world, 1, .2, ob_v3(i ? 1 : -1, 0, 1));
		o.state->v = ob_v3(i ? -2 : 2, 0, 0);
		o.state->w = ob_v3(1, 2 + i, 3);
	}
	ob_world_material(&s->world, 0, 1);
	little_open(&l, s);
	little_run(&l, 120);
	for (uint32_t i = 1; i < 3; i++) {
		const ob_state now = little_state(&l, i), start = s->world.state[i];
		const ob_quat turned = ob_quat_turn(start.pose.q, ob_scale(start.w, 2));
		const double cosine = turned.w * now.pose.q.w + turned.x * now.pose.q.x + turned.y * now.pose.q.y +
				      turned.z * now.pose.q.z;
		CHECK(now.v.x * start.v.x < 0);
		CHECK_NEAR(fabs(cosine), 1, 1e-12);
	}
	little_close(&l);
	free(s);
}

int main(void)
{
	test_attitudes();
	test_in_space(true);
	test_in_space(false);
	test_falling();
	return check_end();
}
