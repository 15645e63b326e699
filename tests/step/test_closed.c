// A closed scene, without gravity and without anything fixed: linear momentum stays, energy never grows. Random scenes
// of spheres and boxes that fly together, each given by its seed.
//   sim_closed coloured|jacobi [FIRST SEED] [SEEDS]
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

static void add_body(little_scene *s, uint64_t *seed, ob_vec3 p, double e)
{
	double mass = pow(10, within(seed, -1, 1)), x = within(seed, .1, .3), y = within(seed, .1, .3);
	ob_vec3 half = ob_v3(x, y, within(seed, .1, .3));
	ob_world_body o =
		uniform(seed) < .4 ? ob_world_sphere(&s->world, mass, x, p) : ob_world_box(&s->world, mass, half, p);
	o.passport->friction = within(seed, 0, 1);
	o.passport->restitution = e;
	o.state->pose.q = random_attitude(seed);
	o.state->v = ob_madd(random_vector(seed, .5), -within(seed, .3, 1.5), p);
	o.state->w = random_vector(seed, 3);
}

// Bodies in a loose grid, moving towards its middle.
static little_scene *closed_scene(uint64_t seed, ob_solver_kind solver)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	s->run.solver = solver;
	int side = 2 + (int)(2 * uniform(&seed));
	double e = uniform(&seed) < .3 ? 0 : uniform(&seed) < .3 ? 1 : uniform(&seed);
	for (int i = 0; i < side * side * side; i++) {
		ob_vec3 cell = ob_v3(i % side, i / side % side, i / side / side);
		ob_vec3 p = ob_scale(ob_sub(cell, ob_scale(ob_v3(1, 1, 1), .5 * (side - 1))), 1.3);
		add_body(s, &seed, ob_add(p, random_vector(&seed, .1)), e);
	}
	return s;
}

static double sum_of_momenta(const little_scene *s)
{
	double sum = 0;
	for (uint32_t i = 0; i < s->world.objects; i++)
		sum += s->world.passport[i].mass * ob_norm(s->world.state[i].v);
	return sum;
}

static void check_scene(uint64_t seed, ob_solver_kind solver)
{
	little_scene *s = closed_scene(seed, solver);
	little_universe l;
	little_open(&l, s);
	ob_vec3 momentum = ob_measure_momentum(&l.now);
	double energy = little_energy(&l), lost = 0, gained = 0;
	int when = 0;
	for (int step = 1; step <= 200; step++) {
		little_run(&l, 1);
		lost = fmax(lost, ob_norm(ob_sub(ob_measure_momentum(&l.now), momentum)) / sum_of_momenta(s));
		double gain = little_energy(&l) / energy - 1;
		if (gain > gained)
			gained = gain, when = step;
	}
	bool met = little_energy(&l) != energy;
	CHECK(met);
	CHECK(lost <= 1e-12);
	CHECK(gained <= 1e-9);
	if (lost > 1e-12 || gained > 1e-9 || !met)
		printf("seed %lu: %u bodies, e %g: momentum off by %.1e, energy grows by %.1e in step %d\n",
		       (unsigned long)seed, s->world.objects, s->world.passport[0].restitution, lost, gained, when);
	little_close(&l);
	free(s);
}

int main(int argc, char **argv)
{
	bool jacobi = argc > 1 && strcmp(argv[1], "jacobi") == 0;
	uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1,
		 seeds = argc > 3 ? strtoull(argv[3], NULL, 10) : 60;
	for (uint64_t seed = first; seed < first + seeds; seed++)
		check_scene(seed, jacobi ? OB_SOLVER_JACOBI : OB_SOLVER_COLOURED);
	return check_end();
}
