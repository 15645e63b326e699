// Tolerances above the default: each is kept, and coarser ones need less computation.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

static const double tolerances[] = { 1e-3, 5e-3, 20e-3, 50e-3 }; // m
enum { TOLERANCES = sizeof tolerances / sizeof *tolerances };

// Settings of the program with this tolerance.
static little_scene *tolerant(double tolerance)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = tolerance;
	s->run.substeps = ob_run_settings_least_substeps(tolerance);
	s->run.iterations = OB_DEFAULT_TOLERANCE_ITERATIONS;
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	return s;
}

typedef struct outcome {
	double worst; // m, at the steps' ends
	ob_counters count;
} outcome;

static outcome watch(little_scene *s, double duration)
{
	little_universe l;
	outcome o = { .worst = 0 };
	little_open(&l, s);
	for (long step = 0; step < lround(60 * duration); step++) {
		little_run(&l, 1);
		o.worst = fmax(o.worst, little_penetration(&l).max_m);
	}
	ob_universe_count(l.u, &o.count);
	little_close(&l);
	free(s);
	return o;
}

// ---- heaps

// Boxes of all sizes that drop in columns.
static void add_falling(little_scene *s, uint64_t seed)
{
	s->world.objects = 0; // they come with a ground
	ob_world_falling(&s->world, 40, seed);
}

// Equal boxes, all aslant, poured from a low height.
static void add_pile(little_scene *s, uint64_t seed)
{
	for (int i = 0; i < 36; i++) {
		const ob_vec3 p = ob_v3(.8 * (i % 3), .8 * (i / 3 % 3), .6 + .8 * (i / 9));
		ob_world_box(&s->world, 10, ob_v3(.2, .2, .2), ob_add(p, random_vector(&seed, .05))).state->pose.q =
			random_attitude(&seed);
	}
}

// Shapes of all kinds that begin close together.
static void add_mixed(little_scene *s, uint64_t seed)
{
	for (int i = 0; i < 30; i++) {
		const ob_vec3 p =
			ob_add(ob_v3(.6 * (i % 3), .6 * (i / 3 % 3), .5 + .6 * (i / 9)), random_vector(&seed, .02));
		ob_world_body o = i % 4 == 0   ? ob_world_sphere(&s->world, 24, .18, p)
				  : i % 4 == 1 ? ob_world_add(&s->world, OB_SHAPE_CYLINDER, ob_v3(.15, .18, 0), 24, p)
				  : i % 4 == 2 ? ob_world_add(&s->world, OB_SHAPE_CAPSULE, ob_v3(.1, .15, 0), 24, p)
					       : ob_world_box(&s->world, 24, ob_v3(.2, .15, .1), p);
		o.state->pose.q = random_attitude(&seed);
	}
}

// Each tolerance is kept. A coarse one is solved less often, tested less often, and by fewer substeps.
static void test_heaps(const char *name, void (*add)(little_scene *, uint64_t), double duration)
{
	enum { SEEDS = 6 };
	double effort[TOLERANCES] = { 0 };
	for (int i = 0; i < TOLERANCES; i++) {
		double worst = 0;
		for (uint64_t seed = 1; seed <= SEEDS; seed++) {
			little_scene *s = tolerant(tolerances[i]);
			add(s, seed);
			const outcome o = watch(s, duration);
			CHECK(o.worst <= tolerances[i]);
			worst = fmax(worst, o.worst);
			effort[i] += (double)(o.count.pair_solves + 4 * o.count.narrowphase_tests);
		}
		printf("%s, %g mm: worst %.3g mm, effort %.0f\n", name, 1e3 * tolerances[i], 1e3 * worst, effort[i]);
		CHECK(i == 0 || effort[i] < effort[i - 1]);
	}
	CHECK(effort[TOLERANCES - 1] < .2 * effort[0]);
}

// ---- standing and rebounding bodies

static void test_stack(double tolerance)
{
	enum { BOXES = 10 };
	little_scene *s = tolerant(tolerance);
	ob_world_stack(&s->world, BOXES, ob_v3(0, 0, 0), 1);
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 600; step++) {
		little_run(&l, 1);
		CHECK(little_penetration(&l).max_m <= tolerance);
	}
	for (uint32_t id = 1; id <= BOXES; id++) {
		const ob_state at = little_state(&l, id);
		CHECK_NEAR(at.pose.p.z, id - .5, id * tolerance);
		CHECK(hypot(at.pose.p.x, at.pose.p.y) <= .1);
		CHECK(little_asleep(&l, id));
	}
	little_close(&l);
	free(s);
}

// Steps until a box that tumbles is asleep.
static long steps_to_sleep(double tolerance)
{
	enum { MOST = 600 };
	little_scene *s = tolerant(tolerance);
	ob_world_box(&s->world, 10, ob_v3(.5, .4, .3), ob_v3(0, 0, .8)).state->w = ob_v3(1, 2, 0);
	little_universe l;
	little_open(&l, s);
	long steps = 0;
	for (; steps < MOST && !little_asleep(&l, 1); steps++)
		little_run(&l, 1);
	little_close(&l);
	free(s);
	return steps;
}

// Bodies that have come to rest sleep as soon as with the default, though the unit of time is longer. They may tumble a
// tenth longer before.
static void test_sleeps_as_soon(void)
{
	const long usual = steps_to_sleep(tolerances[0]);
	for (int i = 1; i < TOLERANCES; i++) {
		const long steps = steps_to_sleep(tolerances[i]);
		printf("asleep after %ld steps at %g mm, %ld at %g\n", steps, 1e3 * tolerances[i], usual,
		       1e3 * tolerances[0]);
		CHECK(steps <= usual + usual / 10);
	}
}

// Rebounds without loss keep the energy, of rotation and of hits in the air, too, with any tolerance.
static void test_energy(double tolerance)
{
	uint64_t seed = 7;
	little_scene *s = tolerant(tolerance);
	s->world.passport[0].restitution = 1;
	for (int i = 0; i < 4; i++) {
		const ob_vec3 p = ob_v3(3 * i, 0, 1.5);
		ob_world_body o = i % 2 ? ob_world_box(&s->world, 8, ob_v3(.3, .2, .25), p)
					: ob_world_sphere(&s->world, 8, .3, p);
		o.passport->restitution = 1;
		o.passport->friction = 0;
		o.state->pose.q = random_attitude(&seed);
		o.state->w = random_vector(&seed, 2);
	}
	s->world.passport[0].friction = 0;
	little_universe l;
	little_open(&l, s);
	const double before = little_energy(&l);
	little_run_to(&l, 8);
	CHECK_NEAR(little_energy(&l) / before, 1, 1e-12);
	little_close(&l);
	free(s);
}

// A box that slides fast over another is checked once in a step: at the next step's start, its pose is the one found.
static void test_looks_once(double tolerance)
{
	enum { SECONDS = 1 };
	little_scene *s = tolerant(tolerance);
	ob_world_box(&s->world, 0, ob_v3(20, 1, .1), ob_v3(0, 0, 4.9));
	ob_world_box(&s->world, 1, ob_v3(.2, .2, .2), ob_v3(-10, 0, 5.2)).state->v = ob_v3(3, 0, 0);
	const outcome o = watch(s, SECONDS);
	printf("tolerance %g: %.0f looks in %d steps\n", tolerance, (double)o.count.narrowphase_tests, 60 * SECONDS);
	CHECK(o.count.narrowphase_tests <= 60 * SECONDS);
}

int main(void)
{
	test_looks_once(50e-3);
	test_sleeps_as_soon();
	test_heaps("falling", add_falling, 4);
	test_heaps("pile", add_pile, 3);
	test_heaps("mixed", add_mixed, 3);
	for (int i = 0; i < TOLERANCES; i++) {
		test_stack(tolerances[i]);
		test_energy(tolerances[i]);
	}
	return check_end();
}
