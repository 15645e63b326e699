// Random worlds of free simulators, some of which are stopped for a while, die, come and go: all come to the end.
#include "hand.h"

#include <math.h>
#include <stdlib.h>

#include "../check.h"

#include "base/random.h"

static const ob_vec3 none = { 0, 0, 0 };
static const double g = 9.81;
static void add_body(hand *h, uint64_t *random, ob_vec3 at, ob_vec3 velocity, double restitution)
{
	const double mass = .5 + ob_splitmix_real(random);
	hand_add(h, ob_splitmix(random) % 2 ? OB_SHAPE_BOX : OB_SHAPE_SPHERE, ob_v3(.2, .2, .2), mass, at, velocity,
		 restitution);
}

// Changes that the host makes while all wait: one comes from outside, one goes.
static void come_and_go(hand *h, uint64_t *random, double radius)
{
	if (ob_splitmix(random) % 2) {
		const uint32_t id = (uint32_t)(ob_splitmix(random) % h->objects);
		if (ob_free_kind_of(h->u, id, NULL) == OB_FREE_SIMULATED)
			hand_remove(h, id);
	}
	if (ob_splitmix(random) % 2) {
		const double angle = 2 * M_PI * ob_splitmix_real(random);
		const ob_vec3 way = ob_v3(cos(angle), sin(angle), 0);
		add_body(h, random, ob_add(ob_scale(way, radius), ob_v3(0, 0, 1)), ob_scale(way, -3), 0);
	}
}

// Runs a world of a seed. lags: simulators step in random orders, are stopped and killed; else the earliest steps first.
static void run_world(uint64_t seed, bool lags)
{
	uint64_t random = seed;
	const double bounds[] = { INFINITY, .0005, .002, .02 };
	ob_free_settings f = { .update_rate = 200 + 800 * ob_splitmix_real(&random),
			       .max_lag = lags ? bounds[ob_splitmix(&random) % 4] : .002,
			       .end = INFINITY,
			       .seed = 1 + seed };
	f.jitter = .5 * ob_splitmix_real(&random);
	f.delay = lags && seed % 5 == 0 ? .01 * ob_splitmix_real(&random) : 0;
	const double gravity = seed % 2 ? g : 0, kills = lags ? .02 : 0, stops = lags ? .01 : 0;
	hand *h = hand_create(f, ob_v3(0, 0, -gravity));
	if (gravity > 0)
		hand_add(h, OB_SHAPE_PLANE, none, 0, none, none, 0);
	const uint32_t n = 3 + (uint32_t)(ob_splitmix(&random) % 7);
	for (uint32_t i = 0; i < n; i++) {
		const ob_vec3 at = ob_v3(.45 * (i % 2), .45 * (i / 2 % 2), .45 * (i / 4));
		add_body(h, &random, ob_add(ob_add(at, ob_v3(0, 0, .4)), ob_splitmix_vector(&random, .02)),
			 ob_add(ob_scale(at, -2), ob_splitmix_vector(&random, 2)), i % 4 ? 0 : .6);
	}
	hand_until(h, 3);
	for (uint64_t step = 3; step <= 24; step += 3) {
		CHECK(lags ? hand_run_with_stops(h, &random, kills, stops) : hand_run_in_order(h));
		CHECK(ob_free_complete(h->u, step) == step);
		come_and_go(h, &random, 1.5 + .3 * (double)step);
		hand_until(h, step + 3);
	}
	hand_destroy(h);
}

// Arguments: the number of worlds, or the first seed and the number of worlds.
int main(int argc, char **argv)
{
	const uint64_t worlds = argc > 1 ? strtoull(argv[argc - 1], NULL, 10) : 20,
		       first = argc > 2 ? strtoull(argv[1], NULL, 10) : 1;
	for (uint64_t seed = first; seed < first + worlds; seed++) {
		run_world(seed, true);
		run_world(seed, false);
	}
	return check_end();
}
