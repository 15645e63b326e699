// A tolerance instead of substeps: the reached error is below it, the reported error covers the measured one, and a
// rejected attempt leaves no trace.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "ode/ode_body.h"

#include "motion/random.h"

static little_scene *tolerant(double tolerance)
{
	little_scene *s = little_scene_new();
	s->run.tolerance = tolerance;
	s->run.substeps = 1;
	s->run.iterations = 64;
	return s;
}

typedef struct outcome {
	double worst, rests; // m, largest at the step boundaries; in the mean of the contacts, at the end
	ob_counters count;
	ob_state top; // last object
} outcome;

static outcome watch(little_scene *s, double duration)
{
	little_universe l;
	outcome o = { .worst = 0 };
	little_open(&l, s);
	for (uint64_t step = 0; step < (uint64_t)lround(60 * duration); step++) {
		little_run(&l, 1);
		o.worst = fmax(o.worst, little_penetration(&l).max_m);
	}
	ob_universe_count(l.u, &o.count);
	o.rests = little_penetration(&l).mean_m;
	o.top = little_state(&l, s->world.objects - 1);
	little_close(&l);
	free(s);
	return o;
}

// The reported error is no smaller than the one measured from outside, and below the tolerance.
static void check_kept(const outcome *o, double tolerance)
{
	CHECK(o->count.error <= tolerance);
	CHECK(o->worst <= o->count.error * 1.05 + 1e-6);
	CHECK(o->count.islands_over == 0);
}

static void test_stack(double tolerance)
{
	little_scene *s = tolerant(tolerance);
	ob_world_ground(&s->world);
	ob_world_stack(&s->world, 10, ob_v3(0, 0, 0), 1);
	outcome o = watch(s, 5);
	check_kept(&o, tolerance);
	CHECK_NEAR(o.top.pose.p.z, 9.5, 10 * tolerance);
}

static void test_heavy_on_light(double tolerance)
{
	little_scene *s = tolerant(tolerance);
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 1, ob_v3(.5, .5, .5), ob_v3(0, 0, .5));
	ob_world_box(&s->world, 100, ob_v3(.5, .5, .5), ob_v3(0, 0, 1.5));
	outcome o = watch(s, 3);
	check_kept(&o, tolerance);
}

// Twelve boxes fall into a heap: steps in which one substep would leave centimetres are solved again with more.
static outcome heap(double tolerance)
{
	uint64_t seed = 3;
	little_scene *s = tolerant(tolerance);
	ob_world_ground(&s->world);
	for (int i = 0; i < 12; i++) {
		ob_vec3 half = ob_add(ob_v3(.3, .3, .3), random_vector(&seed, .15));
		ob_world_body o = ob_world_box(&s->world, 50, half, ob_v3(.3 * (i % 2), .2 * (i % 3), 1.5 + 1.3 * i));
		o.state->pose.q = random_attitude(&seed);
	}
	return watch(s, 4);
}

// Random boxes and spheres, with the program's settings for a tolerance.
static little_scene *random_heap(uint64_t seed, double tolerance)
{
	little_scene *s = tolerant(tolerance);
	s->run.substeps = ob_run_settings_least_substeps(tolerance);
	s->run.sleeping = 1;
	ob_world_ground(&s->world);
	for (int i = 0; i < 24; i++) {
		ob_vec3 p = ob_v3(.55 * (i % 3), .55 * (i / 3 % 3), .5 + .55 * (i / 9));
		p = ob_add(p, random_vector(&seed, .02));
		ob_world_body o = within(&seed, 0, 1) < .5 ? ob_world_sphere(&s->world, 24, .18, p)
							   : ob_world_box(&s->world, 24, ob_v3(.2, .15, .1), p);
		o.state->pose.q = random_attitude(&seed);
	}
	return s;
}

// A tolerance is kept, as measured from outside, and a smaller one gives no deeper rest.
static void test_random_heaps(void)
{
	enum { SEEDS = 6 };
	double rests_before = INFINITY;
	for (double tolerance = 4e-3; tolerance > .1e-3; tolerance /= 4) {
		double rests = 0;
		for (uint64_t seed = 1; seed <= SEEDS; seed++) {
			outcome o = watch(random_heap(seed, tolerance), 2.5);
			CHECK(o.worst <= tolerance);
			CHECK(o.count.islands_over == 0 || o.count.error > tolerance);
			rests += o.rests / SEEDS;
		}
		CHECK(rests <= rests_before);
		printf("tolerance %.4g mm: rests %.2f um deep in the mean\n", 1e3 * tolerance, 1e6 * rests);
		rests_before = rests;
	}
}

// Boxes that land on each other: the error of an island that is solved again falls with its substeps, though iterations
// end before all is at rest.
static void test_falling(void)
{
	enum { SEEDS = 36, BOXES = 60 };
	const double tolerance = 1e-4, missed = 1.1;
	int over = 0;
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		little_scene *s = tolerant(tolerance);
		s->run.substeps = ob_run_settings_least_substeps(tolerance);
		s->run.sleeping = 1;
		ob_world_falling(&s->world, BOXES, seed);
		outcome o = watch(s, 2.5);
		CHECK(o.worst <= tolerance);
		CHECK(o.count.error <= missed * tolerance);
		over += o.count.islands_over > 0;
	}
	printf("falling boxes at %.1g mm: %d of %d runs miss it\n", 1e3 * tolerance, over, SEEDS);
	CHECK(over <= 1);
}

static void test_heap(void)
{
	outcome coarse = heap(5e-3), fine = heap(.5e-3);
	check_kept(&coarse, 5e-3);
	check_kept(&fine, .5e-3);
	CHECK(fine.count.body_substeps > coarse.count.body_substeps);
	CHECK(fine.count.islands_redone > coarse.count.islands_redone);
	// most steps are easy: not all pay for the hardest
	uint64_t easy = fine.count.chosen[0] + fine.count.chosen[1];
	CHECK(easy > fine.count.island_steps / 2);
}

// A rebound that would go higher than the tolerance is made: the last apexes are where the law has them.
// Boxes of all sizes that fall in columns: bodies that never share an island must not overlap either.
static void test_columns(void)
{
	for (uint64_t seed = 1; seed <= 12; seed++) {
		uint64_t random = seed;
		little_scene *s = tolerant(5e-3);
		ob_world_ground(&s->world);
		for (int i = 0; i < 60; i++) {
			double a = within(&random, .1, .5), b = within(&random, .1, .5), c = within(&random, .1, .5);
			ob_vec3 p = ob_v3(1.8 * (i / 4 % 4), 1.8 * (i / 16), 3 + 2 * (i % 4) + within(&random, 0, .2));
			ob_world_body o = ob_world_box(&s->world, 8000 * a * b * c, ob_v3(a, b, c), p);
			ob_vec3 turn = random_vector(&random, 2);
			o.state->pose.q = ob_quat_turn(ob_quat_identity(), turn);
		}
		outcome o = watch(s, 3);
		CHECK(o.worst <= 5e-3);
	}
}

static void test_rebounds(void)
{
	const double tolerance = .5e-3, e = .8, g = 9.81, drop = 1;
	little_scene *s = tolerant(tolerance);
	ob_world_ground(&s->world).passport->restitution = e;
	ob_world_sphere(&s->world, 1, .1, ob_v3(0, 0, .1 + drop));
	little_universe l;
	little_open(&l, s);
	double fall = sqrt(2 * drop / g), at = fall; // s, of each hit
	for (int hop = 1; hop <= 14; hop++) {
		double up = pow(e, hop) * fall; // s, to the apex
		uint64_t apex = (uint64_t)lround(60 * (at + up));
		little_run(&l, apex - ob_step_count(l.u));
		double off = (double)apex / 60 - at - up, height = drop * pow(e, 2 * hop) - .5 * g * off * off;
		if (fabs(off) < up)
			CHECK_NEAR(little_state(&l, 1).pose.p.z - .1, height, tolerance);
		at += 2 * up;
	}
	little_close(&l);
	free(s);
}

// A body that comes to rest needs one substep in the end.
static void test_rest_is_cheap(void)
{
	little_scene *s = tolerant(.5e-3);
	ob_world_ground(&s->world);
	ob_world_box(&s->world, 10, ob_v3(.5, .4, .3), ob_v3(0, 0, 1)).state->w = ob_v3(1, 2, 0);
	little_universe l;
	ob_counters before, after;
	little_open(&l, s);
	little_run_to(&l, 4);
	ob_universe_count(l.u, &before);
	little_run_to(&l, 6);
	ob_universe_count(l.u, &after);
	CHECK(before.chosen[0] > 0);
	for (int i = 1; i < OB_SUBSTEP_CHOICES; i++)
		CHECK(after.chosen[i] == before.chosen[i]);
	CHECK(after.islands_redone == before.islands_redone);
	little_close(&l);
	free(s);
}

// A round body that rolls straight on has the same contact in each step: one substep, and no collision tests.
static void test_rolling_is_cheap(ob_shape shape)
{
	const double radius = .2, speed = 1;
	little_scene *s = tolerant(.5e-3);
	ob_world_ground(&s->world);
	ob_world_body o = ob_world_add(&s->world, shape, ob_v3(radius, .3, 0), 2, ob_v3(0, 0, radius));
	o.state->pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 2, 0, 0));
	o.state->v = ob_v3(speed, 0, 0), o.state->w = ob_v3(0, speed / radius, 0);
	const uint32_t id = o.passport->id;
	little_universe l;
	ob_counters before, after;
	little_open(&l, s);
	little_run_to(&l, 1);
	ob_universe_count(l.u, &before);
	const double from = little_state(&l, id).pose.p.x;
	little_run_to(&l, 3);
	ob_universe_count(l.u, &after);
	CHECK_NEAR(little_state(&l, id).pose.p.x - from, 2 * speed, 1e-9);
	CHECK_NEAR(little_state(&l, id).w.y, speed / radius, 1e-9);
	CHECK(before.chosen[0] > 0);
	for (int i = 1; i < OB_SUBSTEP_CHOICES; i++)
		CHECK(after.chosen[i] == before.chosen[i]);
	CHECK(after.narrowphase_tests == before.narrowphase_tests);
	little_close(&l);
	free(s);
}

// The hash after 2 s; fresh: each step by a simulator that has run nothing before.
static uint64_t hash(ob_integrator integrator, bool fresh)
{
	uint64_t seed = 5;
	little_scene *s = tolerant(.5e-3);
	little_universe l;
	ob_error e;
	s->run.integrator = integrator;
	ob_world_ground(&s->world);
	for (int i = 0; i < 6; i++)
		ob_world_box(&s->world, 5 + i, ob_v3(.3, .2, .25), ob_v3(.1 * i, 0, .5 + .7 * i)).state->pose.q =
			random_attitude(&seed);
	little_open(&l, s);
	for (int step = 0; step < 120; step++) {
		little_run(&l, 1);
		if (!fresh)
			continue;
		ob_sim_destroy(l.sim);
		l.sim = ob_sim_create(l.u, 0, &e);
		if (!l.sim)
			exit(1);
	}
	ob_counters count;
	ob_universe_count(l.u, &count);
	CHECK(count.islands_redone > 0);
	uint64_t h = ob_measure_hash(&l.now);
	little_close(&l);
	free(s);
	return h;
}

// ODE's bodies and the scratch memory keep nothing of a rejected solution.
static void test_no_trace(void)
{
	CHECK(hash(OB_INTEGRATOR_EXACT, true) == hash(OB_INTEGRATOR_EXACT, false));
	CHECK(hash(OB_INTEGRATOR_ODE, true) == hash(OB_INTEGRATOR_ODE, false));
}

// Cribs of boards, two on each level, with gaps between levels, come down: each board sinks by the gaps below it, to the
// tolerance, or the report says that its motion may be off by more. Each contact alone is far within it.
static void test_crib(int levels, double thickness, double gap, double mu)
{
	const double tolerance = 1e-3;
	little_scene *s = little_scene_new();
	s->run.tolerance = tolerance;
	ob_world_ground(&s->world);
	for (int i = 0; i < levels; i++)
		for (int side = -1; side <= 1; side += 2) {
			const ob_vec3 along = ob_v3(.06, .012, .5 * thickness),
				      across = ob_v3(.012, .06, .5 * thickness);
			const double z = .5 * thickness + i * (thickness + gap), aside = .048 * side;
			ob_world_box(&s->world, 600 * .12 * .024 * thickness, i % 2 ? across : along,
				     i % 2 ? ob_v3(aside, 0, z) : ob_v3(0, aside, z));
		}
	ob_world_material(&s->world, mu, 0);
	const double due = (levels - .5) * thickness;
	const outcome o = watch(s, 3);
	CHECK(o.count.unbounded > 0 || fabs(o.top.pose.p.z - due) <= tolerance);
}

static void test_cribs(void)
{
	for (int levels = 10; levels <= 40; levels += 15)
		for (double thickness = .0078; thickness < .05; thickness *= 2.5)
			for (double gap = 1e-4; gap < 1e-3; gap *= 5)
				test_crib(levels, thickness, gap, .5);
}

// A block that leans rocks from edge to edge. Its pivot, already there, is no corner that may hit first.
static little_scene *rocking(void)
{
	little_scene *s = tolerant(1e-3);
	const ob_vec3 half = ob_v3(.06, .15, .25);
	ob_world_body block = ob_world_box(&s->world, 10, half, ob_v3(0, 0, 0));
	const ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, .06, 0));
	const ob_mat3 r = ob_quat_matrix(q);
	block.state->pose.q = q;
	block.state->pose.p = ob_rotate(&r, ob_v3(-half.x, 0, half.z));
	return s;
}

// A plank on rollers. What iterations leave of a velocity is taken back in the next step.
static little_scene *on_rollers(void)
{
	little_scene *s = tolerant(1e-3);
	for (int i = 0; i < 4; i++)
		ob_world_cylinder(&s->world, 5, .08, .25, ob_v3(.3 * i, 0, .08)).state->pose.q =
			ob_quat_turn(ob_quat_identity(), ob_v3(M_PI / 2, 0, 0));
	ob_world_box(&s->world, 20, ob_v3(.9, .2, .04), ob_v3(.45, 0, .2)).state->v = ob_v3(.3, 0, 0);
	return s;
}

// Motion that is well within the tolerance is said to be bounded.
static void test_no_false_alarm(little_scene *s)
{
	ob_world_ground(&s->world);
	ob_world_material(&s->world, .6, 0);
	s->run.substeps = 8;
	const outcome o = watch(s, 1);
	printf("motion is off by %.3g mm a second, by estimate\n", 1e3 * o.count.deviation);
	CHECK(o.count.unbounded == 0);
}

int main(void)
{
	test_no_false_alarm(rocking());
	test_no_false_alarm(on_rollers());
	for (double tolerance = 5e-3; tolerance > .04e-3; tolerance /= 10) {
		test_stack(tolerance);
		test_heavy_on_light(tolerance);
	}
	test_falling();
	test_heap();
	test_random_heaps();
	test_columns();
	test_cribs();
	test_rebounds();
	test_rest_is_cheap();
	test_rolling_is_cheap(OB_SHAPE_CYLINDER);
	test_rolling_is_cheap(OB_SHAPE_CAPSULE);
	test_no_trace();
	return check_end();
}
