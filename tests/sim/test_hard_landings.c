// Hard case: a thousand boxes fall in columns of four, and land on the ground and on each other at up to 11 m/s. No
// engine that resolves contacts once a step comes near: 150 to 600 mm deep at worst.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

int main(void)
{
	uint64_t seed = 17;
	little_scene *s = little_scene_new();
	little_ground(s);
	for (int column = 0; column < 250; column++) {
		double z = 1;
		for (int i = 0; i < 4; i++) {
			z += 1.8 + uniform(&seed);
			double x = within(&seed, .1, .5), y = within(&seed, .1, .5);
			ob_vec3 half = ob_v3(x, y, within(&seed, .1, .5));
			ob_vec3 p = ob_v3((column % 16 - 7.5) * 1.8, (column / 16 - 7.5) * 1.8, z);
			little_object *o = little_box(s, 8000 * half.x * half.y * half.z, half, p);
			o->state.pose.q = random_attitude(&seed);
		}
	}
	little_universe l;
	little_open(&l, s);
	double deepest = 0, energy = little_energy(&l);
	for (int step = 1; step <= 600; step++) {
		little_run(&l, 1);
		ob_penetration p = little_penetration(&l);
		deepest = fmax(deepest, p.max_m);
		CHECK(little_energy(&l) <= energy * (1 + 1e-9));
	}
	ob_penetration rest = little_penetration(&l);
	printf("1000 boxes: %.2f mm deep at worst, at rest %.3f mm at most and %.3f mm on average\n", 1e3 * deepest,
	       1e3 * rest.max_m, 1e3 * rest.mean_m);
	CHECK(deepest <= 5e-3);
	CHECK(rest.mean_m <= .1e-3);
	little_close(&l);
	free(s);
	return check_end();
}
