// Clouds of small bodies that fall fast and close together: each has few neighbours, whatever the cloud does.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

// n grains of a centimetre, a diameter and a half apart, that fall with this speed from the start, and go apart at up
// to "spread". Returns the most pairs that there were for each.
static double most_pairs_each(uint32_t n, double speed, double spread, int steps)
{
	uint64_t seed = 3;
	little_scene *s = little_scene_new();
	const uint32_t side = (uint32_t)ceil(cbrt(n));
	s->run.tolerance = 1e-3;
	ob_world_ground(&s->world);
	for (uint32_t i = 0; i < n; i++) {
		ob_vec3 cell = ob_v3(i % side, i / side % side, i / (side * side));
		ob_vec3 p = ob_add(ob_scale(cell, .015), random_vector(&seed, .002));
		ob_world_body o = ob_world_sphere(&s->world, .001, .005, ob_add(p, ob_v3(0, 0, 40)));
		o.state->v = ob_add(random_vector(&seed, spread), ob_v3(0, 0, -speed));
	}
	little_universe u;
	little_open(&u, s);
	uint32_t most = 0;
	for (int i = 0; i < steps; i++) {
		little_run(&u, 1);
		uint32_t pairs = ob_universe_step_data(u.u)->count->pairs;
		most = pairs > most ? pairs : most;
	}
	little_close(&u);
	free(s);
	return (double)most / n;
}

int main(void)
{
	double still = most_pairs_each(400, 0, 0, 60), wild = most_pairs_each(400, 0, .2, 20);
	double fast = most_pairs_each(1500, 20, 0, 20);
	printf("pairs for each grain: %.1f of a cloud that is let go, %.1f if it is stirred, %.1f at 20 m/s\n", still,
	       wild, fast);
	CHECK(still < 40);
	CHECK(wild < 80);
	CHECK(fast < 80);
	return check_end();
}
