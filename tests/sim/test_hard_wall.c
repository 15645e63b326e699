// Hard cases: a box of 20 cm flies at a fixed wall of 2 cm, turned and aimed at random, 10 to 1000 m/s; two such boxes
// fly at each other. None passes.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

enum { AIMS = 100 };

typedef struct shot {
	double furthest; // m, of the box's centre; the wall's middle is at 0, and it starts on the negative side
	bool hit; // it lost speed
} shot;

static shot shoot(uint64_t *seed, double speed)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	little_box(s, 0, ob_v3(.01, 2, 2), ob_v3(0, 0, 0));
	double x = -within(seed, 3, 4), y = within(seed, -.25, .25), z = within(seed, -.25, .25);
	little_object *o = little_box(s, 1, ob_v3(.1, .1, .1), ob_v3(x, y, z));
	o->state.pose.q = random_attitude(seed);
	o->state.v = random_vector(seed, .1 * speed);
	o->state.v.x = speed;
	o->state.w = random_vector(seed, 1);
	little_universe l;
	little_open(&l, s);
	int steps = (int)(60 * 5 / speed) + 4; // 5 m of way
	shot out = { x, false };
	for (int k = 0; k < steps; k++) {
		little_run(&l, 1);
		ob_state now = little_state(&l, 1);
		out.furthest = fmax(out.furthest, now.pose.p.x);
		out.hit |= now.v.x < .99 * speed;
	}
	little_close(&l);
	free(s);
	return out;
}

typedef struct duel {
	bool slower; // they hit
	bool sides; // they have changed sides
	double gained; // energy, relative
} duel;

// Two boxes, up to 5 cm off the line on which they meet.
static duel fight(uint64_t *seed, double speed, uint32_t substeps)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.substeps = substeps;
	for (int i = 0; i < 2; i++) {
		double side = i ? 1 : -1, x = within(seed, 3, 4), y = within(seed, -.025, .025);
		little_object *o = little_box(s, 1, ob_v3(.1, .1, .1), ob_v3(side * x, y, within(seed, -.025, .025)));
		o->passport.friction = .3;
		o->state.pose.q = random_attitude(seed);
		o->state.w = random_vector(seed, 1);
		o->state.v.x = -side * speed;
	}
	little_universe l;
	little_open(&l, s);
	double energy = little_energy(&l);
	little_run(&l, 3 + (uint64_t)(60 * 5 / speed));
	ob_state a = little_state(&l, 0), b = little_state(&l, 1);
	duel out = { a.v.x - b.v.x<speed, a.pose.p.x> b.pose.p.x, little_energy(&l) / energy - 1 };
	little_close(&l);
	free(s);
	return out;
}

// Some corners slip past each other, and the two fly on as they turn round each other; whether they do is known from
// runs that are made in a hundred times as many substeps.
static void test_duels(double speed, int aims)
{
	uint64_t seed = 19;
	int hit = 0, passed = 0, slipped = 0;
	for (int k = 0; k < aims; k++) {
		uint64_t same = seed;
		duel x = fight(&seed, speed, 8), fine = fight(&same, speed, 4000);
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
	static const double speed[] = { 10, 30, 100, 300, 1000 };
	uint64_t seed = 18;
	for (int i = 0; i < 5; i++) {
		int hit = 0, passed = 0;
		for (int k = 0; k < AIMS; k++) {
			shot x = shoot(&seed, speed[i]);
			hit += x.hit;
			passed += x.furthest > -.05; // half of it inside is as bad as through
		}
		printf("%g m/s: %d of %d hit the wall, %d passed\n", speed[i], hit, AIMS, passed);
		CHECK(hit == AIMS);
		CHECK(passed == 0);
	}
	test_duels(200, 100);
	test_duels(500, 100);
	test_duels(1000, 100);
	return check_end();
}
