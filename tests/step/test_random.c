// In any scene, contact and friction dissipate energy and never add any, momentum changes by external forces alone, and
// every state is finite. Random scenes of 2 to 12 boxes and spheres, each given by its seed: a third in free space, a
// third between six walls, a third between six walls with gravity.
//   sim_random [FIRST SEED] [SEEDS]      5000 seeds are a million steps
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

enum { STEPS = 200, FREE = 0, WALLS = 1, ROOM = 2 };

static const double half_room = 1.6; // m

static uint64_t running; // seed

static void say_seed(void)
{
	if (running)
		printf("it was the scene of seed %lu\n", (unsigned long)running);
}

static void add_wall(little_scene *s, ob_vec3 turn, ob_vec3 normal, double e)
{
	ob_world_body o = ob_world_add(&s->world, OB_SHAPE_PLANE, ob_v3(0, 0, 0), 0, ob_scale(normal, -half_room));
	o.state->pose.q = ob_quat_turn(ob_quat_identity(), turn);
	o.passport->restitution = e;
}

static void add_walls(little_scene *s, double e)
{
	static const double quarter = 1.5707963267948966;
	add_wall(s, ob_v3(0, 0, 0), ob_v3(0, 0, 1), e);
	add_wall(s, ob_v3(2 * quarter, 0, 0), ob_v3(0, 0, -1), e);
	add_wall(s, ob_v3(0, quarter, 0), ob_v3(1, 0, 0), e);
	add_wall(s, ob_v3(0, -quarter, 0), ob_v3(-1, 0, 0), e);
	add_wall(s, ob_v3(-quarter, 0, 0), ob_v3(0, 1, 0), e);
	add_wall(s, ob_v3(quarter, 0, 0), ob_v3(0, -1, 0), e);
}

static double random_restitution(uint64_t *seed)
{
	double kind = uniform(seed), e = uniform(seed);
	return kind < .25 ? 0 : kind < .5 ? 1 : e;
}

static void add_body(little_scene *s, uint64_t *seed, ob_vec3 p, double round, double e)
{
	double mass = pow(10, within(seed, -1, 1)), x = within(seed, .05, .25), y = within(seed, .05, .25);
	ob_vec3 half = ob_v3(x, y, within(seed, .05, .25));
	ob_world_body o =
		uniform(seed) < round ? ob_world_sphere(&s->world, mass, x, p) : ob_world_box(&s->world, mass, half, p);
	o.passport->friction = within(seed, 0, 1);
	o.passport->restitution = e;
	o.state->pose.q = random_attitude(seed);
	o.state->v = ob_madd(random_vector(seed, 2), -within(seed, 0, 2), p);
	o.state->w = random_vector(seed, 5);
}

// Bodies in the cells of a grid
static little_scene *random_scene(uint64_t seed, int kind)
{
	little_scene *s = little_scene_new();
	double e = random_restitution(&seed), round = (double)(seed / 3 % 3) / 2;
	bool mixed = uniform(&seed) < .5;
	int bodies = 2 + (int)(11 * uniform(&seed));
	if (kind != ROOM)
		s->run.gravity = ob_v3(0, 0, 0);
	if (kind != FREE)
		add_walls(s, e);
	for (int i = 0; i < bodies; i++) {
		ob_vec3 cell = ob_v3(i % 3 - 1, i / 3 % 2 - .5, i / 6 - .5);
		ob_vec3 p = ob_add(ob_scale(cell, 1), random_vector(&seed, .05));
		add_body(s, &seed, p, round, mixed ? random_restitution(&seed) : e);
	}
	return s;
}

typedef struct course {
	double scale; // J, energy above the minimum
	double gross, net; // growth over the start, relative; net of what pushing penetrations apart has raised
	double rise; // net, over the least so far
	double lost, lost_spin; // momentum and angular momentum, relative to the sum of all bodies'
} course;

// Energy above the lowest possible
static double energy_to_lose(const little_universe *l)
{
	double sum = 0;
	ob_vec3 g = l->scene->run.gravity;
	for (uint32_t i = 0; i < l->scene->world.objects; i++)
		sum += l->scene->world.passport[i].mass * ob_norm(g) * half_room;
	return little_energy(l) + sum;
}

static course follow(const little_scene *s)
{
	course c = { 0 };
	little_universe l;
	ob_counters count;
	little_open(&l, s);
	double energy = little_energy(&l), all = 0, spin = 0, least = 0;
	ob_vec3 p = ob_measure_momentum(&l.now), turn = ob_measure_angular_momentum(&l.now);
	for (uint32_t i = 0; i < s->world.objects; i++) {
		const ob_state *o = &s->world.state[i];
		const double momentum = s->world.passport[i].mass * ob_norm(o->v);
		all += momentum;
		spin += momentum * (1 + ob_norm(o->pose.p));
	}
	c.scale = energy_to_lose(&l);
	for (int step = 0; step < STEPS; step++) {
		little_run(&l, 1);
		ob_universe_count(l.u, &count);
		double gained = little_energy(&l) - energy;
		c.gross = fmax(c.gross, gained / c.scale);
		c.net = fmax(c.net, (gained - count.recovered) / c.scale);
		least = fmin(least, gained - count.recovered);
		c.rise = fmax(c.rise, (gained - count.recovered - least) / c.scale);
		c.lost = fmax(c.lost, ob_norm(ob_sub(ob_measure_momentum(&l.now), p)) / all);
		c.lost_spin = fmax(c.lost_spin, ob_norm(ob_sub(ob_measure_angular_momentum(&l.now), turn)) / spin);
	}
	little_close(&l);
	return c;
}

int main(int argc, char **argv)
{
	uint64_t first = argc > 1 ? strtoull(argv[1], NULL, 10) : 1,
		 seeds = argc > 2 ? strtoull(argv[2], NULL, 10) : 2000;
	course worst = { 0 };
	atexit(say_seed);
	for (running = first; running < first + seeds; running++) {
		int kind = (int)(running % 3), failed = check_failed;
		little_scene *s = random_scene(running, kind);
		course c = follow(s);
		free(s);
		CHECK(c.gross <= 1e-5);
		CHECK(c.net <= 1e-9);
		// A resting body that is hit loses its support at the partial substep's start, not at the impact.
		CHECK(c.rise <= 3e-4);
		if (kind == FREE) {
			CHECK(c.lost <= 1e-13);
			worst.lost = fmax(worst.lost, c.lost);
			worst.lost_spin = fmax(worst.lost_spin, c.lost_spin);
		}
		if (check_failed > failed)
			printf("seed %lu: growth %.1e gross, %.1e net, %.1e over the least before, momentum off by "
			       "%.1e\n",
			       (unsigned long)running, c.gross, c.net, c.rise, c.lost);
		worst.gross = fmax(worst.gross, c.gross);
		worst.net = fmax(worst.net, c.net);
		worst.rise = fmax(worst.rise, c.rise);
	}
	running = 0;
	printf("%lu scenes of %d steps: growth %.1e gross, %.1e net, %.1e over the least before; momentum off by %.1e, "
	       "angular momentum by %.1e\n",
	       (unsigned long)seeds, STEPS, worst.gross, worst.net, worst.rise, worst.lost, worst.lost_spin);
	return check_end();
}
