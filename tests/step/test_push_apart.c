// Two bodies that overlap at the start, without external forces, are pushed apart: momentum and angular momentum are
// conserved, and energy does not grow, while they rotate and slide past each other. Random pairs, each given by its
// seed.
//   sim_push_apart [FIRST SEED] [SEEDS]
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

static const double depth = 2e-3; // m, at the start

// Adds a body whose surface is normal to x at its largest x, which is returned.
static double add_body(little_scene *s, uint64_t *seed, ob_vec3 p)
{
	static const ob_shape shapes[] = { OB_SHAPE_SPHERE, OB_SHAPE_BOX, OB_SHAPE_CAPSULE, OB_SHAPE_CYLINDER };
	const ob_shape shape = shapes[(int)(4 * uniform(seed))];
	const double x = within(seed, .1, .3), y = within(seed, .1, .3), z = within(seed, .1, .3);
	const ob_vec3 size = ob_v3(x, shape == OB_SHAPE_SPHERE ? 0 : y, shape == OB_SHAPE_BOX ? z : 0);
	ob_world_body body = ob_world_add(&s->world, shape, size, pow(10, within(seed, -1, 1)), p);
	body.passport->friction = within(seed, 0, 1);
	body.passport->restitution = uniform(seed) < .5 ? 0 : uniform(seed);
	body.state->v = random_vector(seed, 1);
	body.state->w = random_vector(seed, 5);
	return x;
}

static little_scene *overlapping_pair(uint64_t seed, double tolerance)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = tolerance;
	const double first = add_body(s, &seed, ob_v3(0, 0, 0)), second = add_body(s, &seed, ob_v3(0, 0, 0));
	s->state[1].pose.p.x = first + second - depth;
	return s;
}

static void check_pair(uint64_t seed, double tolerance)
{
	little_scene *s = overlapping_pair(seed, tolerance);
	little_universe l;
	little_open(&l, s);
	const ob_vec3 momentum = ob_measure_momentum(&l.now), angular = ob_measure_angular_momentum(&l.now);
	const double energy = little_energy(&l);
	double lost = 0, turned = 0, gained = 0, least = energy;
	for (int step = 0; step < 60; step++) {
		little_run(&l, 1);
		lost = fmax(lost, ob_norm(ob_sub(ob_measure_momentum(&l.now), momentum)) / ob_norm(momentum));
		turned = fmax(turned, ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), angular)) / ob_norm(angular));
		gained = fmax(gained, (little_energy(&l) - least) / energy);
		least = fmin(least, little_energy(&l));
	}
	const double left = little_penetration(&l).max_m;
	CHECK(lost <= 1e-12);
	CHECK(turned <= 1e-12);
	CHECK(gained <= 1e-12);
	CHECK(left <= depth / 4);
	if (lost > 1e-12 || turned > 1e-12 || gained > 1e-12 || left > depth / 4)
		printf("seed %lu, tolerance %g: momentum off by %.1e, angular momentum by %.1e, energy grows by %.1e, "
		       "%.3f mm deep\n",
		       (unsigned long)seed, tolerance, lost, turned, gained, 1e3 * left);
	little_close(&l);
	free(s);
}

// Smooth elastic balls that pass each other while they are pushed apart keep their energy.
static void check_balls(double aside)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.tolerance = 1e-3;
	for (int i = 0; i < 2; i++)
		ob_world_sphere(&s->world, 1 + i, .2, ob_v3(i * (.4 - depth), 0, 0)).state->v =
			ob_v3(i ? -.5 : .5, i ? -aside : aside, 0);
	ob_world_material(&s->world, 0, 1);
	little_universe l;
	little_open(&l, s);
	const double energy = little_energy(&l);
	little_run(&l, 60);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-12);
	CHECK(little_penetration(&l).max_m == 0);
	little_close(&l);
	free(s);
}

int main(int argc, char **argv)
{
	const uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
		       seeds = argc > 2 ? strtoull(argv[2], NULL, 10) : 100;
	for (uint64_t seed = first; seed < first + seeds; seed++)
		for (double tolerance = 1e-3; tolerance > 5e-6; tolerance /= 10)
			check_pair(seed, tolerance);
	for (double aside = .1; aside < 10; aside *= 2)
		check_balls(aside);
	return check_end();
}
