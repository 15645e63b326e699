// Hard cases with an exact answer: the thrown box, the head-on pair, Newton's cradle, the ball that bounces a hundred
// times, the heights of a ball that loses some each time; and heaps of spheres, and a flat box that bounces.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

#include "motion/random.h"

static const double g = 9.81; // m/s^2

static void test_projectile(void)
{
	little_scene *s = little_scene_new();
	little_object *o = little_box(s, 48, ob_v3(.3, .2, .1), ob_v3(0, 0, 5));
	o->state.v = ob_v3(10, 0, 10);
	o->state.w = ob_v3(1, 2, 3);
	little_universe l;
	little_open(&l, s);
	double worst = 0, energy = little_energy(&l);
	for (int step = 1; step <= 120; step++) {
		double t = step / 60.;
		little_run(&l, 1);
		ob_vec3 exact = ob_v3(10 * t, 0, 5 + 10 * t - .5 * g * t * t);
		worst = fmax(worst, ob_norm(ob_sub(little_state(&l, 0).pose.p, exact)));
	}
	CHECK_NEAR(worst, 0, 1e-12);
	CHECK_NEAR(little_energy(&l) / energy, 1, 1e-12);
	little_close(&l);
	free(s);
}

// 1 m wide, the first at 1 m/s, the second at rest.
static void head_on(ob_shape shape, double ratio, double e)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 2; i++) {
		little_object *o = little_add(s, shape, ob_v3(.5, .5, .5), i ? ratio : 1, ob_v3(i * 1.537, 0, 0));
		o->passport.friction = .3;
		o->passport.restitution = e;
	}
	s->object[0].state.v.x = 1;
	little_universe l;
	little_open(&l, s);
	double before = little_energy(&l), most = before;
	for (int step = 0; step < 120; step++) {
		little_run(&l, 1);
		most = fmax(most, little_energy(&l));
	}
	double tolerance = e > 0 ? 1e-12 : 1e-8;
	ob_vec3 a = little_state(&l, 0).v, b = little_state(&l, 1).v, m = ob_measure_momentum(&l.now);
	CHECK_NEAR(a.x, (1 - e * ratio) / (1 + ratio), tolerance);
	CHECK_NEAR(b.x, (1 + e) / (1 + ratio), tolerance);
	CHECK_NEAR(ob_norm(ob_v3(a.y, a.z, 0)) + ob_norm(ob_v3(b.y, b.z, 0)), 0, tolerance);
	CHECK_NEAR(ob_norm(ob_sub(m, ob_v3(1, 0, 0))), 0, 1e-15);
	CHECK(most <= before * (1 + 1e-15));
	little_close(&l);
	free(s);
}

static void test_head_on(void)
{
	static const double restitution[] = { 0, .5, 1 };
	for (int i = 0; i < 3; i++)
		for (int heavy = 0; heavy < 2; heavy++) {
			head_on(OB_SHAPE_SPHERE, heavy ? 1000 : 1, restitution[i]);
			head_on(OB_SHAPE_BOX, heavy ? 1000 : 1, restitution[i]);
		}
}

// As many as come in leave at the other end, as fast; the others rest.
static void test_cradle(int incoming)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 5; i++) {
		double x = i + (i < incoming ? 0 : .7);
		little_object *o = little_sphere(s, 1, .5, ob_v3(x, 0, 0));
		o->passport.friction = 0;
		o->passport.restitution = 1;
		o->state.v.x = i < incoming;
	}
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	for (int i = 0; i < 5; i++)
		CHECK_NEAR(little_state(&l, (uint32_t)i).v.x, i >= 5 - incoming, 1e-9);
	little_close(&l);
	free(s);
}

// Balls with a centimetre between them: the impact of the first runs through all of them within a step.
static void test_spaced_row(double speed)
{
	little_scene *s = little_scene_new();
	s->run.gravity = ob_v3(0, 0, 0);
	for (int i = 0; i < 8; i++) {
		little_object *o = little_sphere(s, 1, .1, ob_v3(.21 * i, 0, 0));
		o->passport.restitution = 1;
		o->state.v.x = i ? 0 : speed;
	}
	little_universe l;
	little_open(&l, s);
	for (int step = 0; step < 60; step++) {
		little_run(&l, 1);
		CHECK_NEAR(little_penetration(&l).max_m, 0, 1e-9);
	}
	for (uint32_t i = 0; i < 8; i++)
		CHECK_NEAR(little_state(&l, i).v.x, i == 7 ? speed : 0, 1e-9);
	little_close(&l);
	free(s);
}

static void ball_over_ground(little_scene *s, double radius, double e)
{
	little_ground(s);
	little_sphere(s, 1, radius, ob_v3(0, 0, 1 + radius))->passport.restitution = e;
}

static void test_hundred_bounces(void)
{
	little_scene *s = little_scene_new();
	ball_over_ground(s, .5, 1);
	little_universe l;
	little_open(&l, s);
	double before = little_energy(&l), worst = 0, last = 0;
	int bounces = 0;
	while (bounces < 100 && ob_step_count(l.u) < 6000) {
		little_run(&l, 1);
		double v = little_state(&l, 1).v.z;
		bounces += last < 0 && v > 0;
		last = v;
		worst = fmax(worst, fabs(little_energy(&l) / before - 1));
	}
	CHECK(bounces == 100);
	CHECK_NEAR(ob_step_count(l.u) / 60., 199 * sqrt(2 / g), .02);
	CHECK_NEAR(worst, 0, 1e-12);
	little_close(&l);
	free(s);
}

// Heights of the bottom: h e^(2k) after k bounces.
static void test_apexes(void)
{
	little_scene *s = little_scene_new();
	ball_over_ground(s, .1, .8);
	little_universe l;
	little_open(&l, s);
	double last = 0, expected = 1;
	int bounces = 0;
	while (bounces < 4 && ob_step_count(l.u) < 300) {
		little_run(&l, 1);
		ob_state b = little_state(&l, 1);
		if (last < 0 && b.v.z > 0) {
			bounces++;
			expected *= .64;
			CHECK_NEAR(b.pose.p.z - .1 + b.v.z * b.v.z / (2 * g), expected, 1e-9);
		}
		last = b.v.z;
	}
	CHECK(bounces == 4);
	little_close(&l);
	free(s);
}

// SimBenchmark's bouncing test: 49 elastic spheres, 20 s; mean of the squared error of the energy (J^2).
static void test_bouncing_spheres(void)
{
	little_scene *s = little_scene_new();
	little_ground(s)->passport.friction = 0;
	for (int i = 0; i < 49; i++) {
		little_object *o = little_sphere(s, 10, .1, ob_v3(2 * (i % 7), 2 * (i / 7), 5));
		o->passport.friction = 0;
		o->passport.restitution = 1;
	}
	little_universe l;
	little_open(&l, s);
	double sum = 0;
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		double error = little_energy(&l) - 49 * 10 * g * 5;
		sum += error * error;
	}
	CHECK_NEAR(sum / 1200, 0, 1e-8);
	little_close(&l);
	free(s);
}

// A flat box that bounces on its edges and corners turns from each to the next and keeps its energy, or loses some to
// friction and where it comes to lie.
static void test_flat_box(double friction, double tilt)
{
	little_scene *s = little_scene_new();
	little_ground(s);
	little_object *o = little_box(s, 1, ob_v3(.5, .5, .05), ob_v3(0, 0, 1.05));
	o->passport.restitution = 1;
	o->passport.friction = friction;
	o->state.pose.q = ob_quat_turn(ob_quat_identity(), ob_v3(tilt, .02, 0));
	little_universe l;
	little_open(&l, s);
	double before = little_energy(&l), most = 0, deepest = 0;
	for (int step = 0; step < 1200; step++) {
		little_run(&l, 1);
		most = fmax(most, little_energy(&l) / before - 1);
		deepest = fmax(deepest, little_penetration(&l).max_m);
	}
	CHECK(most <= 1e-9);
	CHECK(deepest <= 1e-3);
	if (friction == 0)
		CHECK(little_energy(&l) >= .9 * before);
	little_close(&l);
	free(s);
}

static little_scene *cube_of_spheres(uint64_t seed, double height, double e)
{
	little_scene *s = little_scene_new();
	little_ground(s)->passport.friction = 0;
	for (int i = 0; i < 216; i++) {
		ob_vec3 p = ob_scale(ob_v3(i % 6, i / 6 % 6, i / 36), .21);
		for (double *x = &p.x; x <= &p.z; x++)
			*x += .001 * uniform(&seed);
		little_object *o = little_sphere(s, 10, .1, ob_add(p, ob_v3(0, 0, height)));
		o->passport.friction = 0;
		o->passport.restitution = e;
	}
	return s;
}

// m^2, squared depths of all touching pairs; spheres stand above the ground and each other
static double squared_depths(const little_universe *l)
{
	double sum = 0;
	for (uint32_t i = 1; i < l->scene->objects; i++) {
		ob_vec3 a = little_state(l, i).pose.p;
		double depth = fmax(0, .1 - a.z);
		sum += depth * depth;
		for (uint32_t k = 1; k < i; k++) {
			depth = fmax(0, .2 - ob_norm(ob_sub(a, little_state(l, k).pose.p)));
			sum += depth * depth;
		}
	}
	return sum;
}

// SimBenchmark's 666: 6^3 spheres fall into a heap, plastic or elastic, 10 s.
static void test_666(void)
{
	little_scene *s = cube_of_spheres(7, .101, 0);
	little_universe l;
	little_open(&l, s);
	double sum = 0;
	for (int step = 0; step < 600; step++) {
		little_run(&l, 1);
		sum += squared_depths(&l);
	}
	printf("666: %.1e m^2 of squared depths\n", sum / 600);
	CHECK(sum / 600 <= 1e-5);
	little_close(&l);
	free(s);
}

static void test_elastic_666(void)
{
	little_scene *s = cube_of_spheres(8, 1.101, 1);
	little_universe l;
	little_open(&l, s);
	double sum = 0, before = little_energy(&l);
	for (int step = 0; step < 600; step++) {
		little_run(&l, 1);
		sum += pow(little_energy(&l) / before - 1, 2);
	}
	printf("elastic 666: energy off by %.1e\n", sqrt(sum / 600));
	CHECK(sqrt(sum / 600) <= 1e-3);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_666();
	test_elastic_666();
	test_flat_box(0, .2);
	test_flat_box(.5, .2);
	test_flat_box(.5, .001);
	test_bouncing_spheres();
	test_projectile();
	test_head_on();
	test_cradle(1);
	test_cradle(2);
	test_spaced_row(4);
	test_spaced_row(10);
	test_spaced_row(40);
	test_hundred_bounces();
	test_apexes();
	return check_end();
}
