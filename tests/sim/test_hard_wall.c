// Hard case: a box of 20 cm flies at a fixed wall of 2 cm, turned and aimed at random, 10 to 1000 m/s. None passes.
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
	return check_end();
}
