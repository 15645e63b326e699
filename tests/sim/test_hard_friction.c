// Hard cases of dry friction: stick and slip on an incline, sliding the same way in every direction, a ball that slides
// until it rolls, a ball on an incline.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"

static const double g = 9.81; // m/s^2

typedef struct slope {
	ob_quat q;
	ob_vec3 down, normal;
} slope;

static slope incline(double angle)
{
	ob_quat q = ob_quat_turn(ob_quat_identity(), ob_v3(0, angle, 0));
	ob_mat3 r = ob_quat_matrix(q);
	return (slope){ q, ob_column(&r, 0), ob_column(&r, 2) };
}

// How far a box of 1 x 1 x .5 m gets down a slope of this angle within the time (m); mu = .5
static double slid(double angle, double time)
{
	little_scene *s = little_scene_new();
	slope i = incline(angle);
	little_ground(s)->state.pose.q = i.q;
	little_object *o = little_box(s, 500, ob_v3(.5, .5, .25), ob_scale(i.normal, .25));
	o->state.pose.q = i.q;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	double way = ob_dot(i.down, ob_sub(little_state(&l, 1).pose.p, o->state.pose.p));
	little_close(&l);
	free(s);
	return way;
}

static void test_incline(void)
{
	double friction = atan(.5), steep = 1.01 * friction;
	double creep = slid(.99 * friction, 10), a = g * (sin(steep) - .5 * cos(steep)), way = slid(steep, 4);
	printf("incline: creep %.2e mm, slide off by %.2e\n", 1e3 * creep, way / (8 * a) - 1);
	CHECK_NEAR(creep, 0, 1e-5);
	CHECK_NEAR(way / (.5 * a * 16), 1, .003);
}

// Twelve headings: the same way and the same time to rest.
static void test_isotropic(void)
{
	double least = INFINITY, most = 0, exact = 9 / (2 * .5 * g);
	for (int i = 0; i < 12; i++) {
		double heading = i * M_PI / 6 + .1;
		little_scene *s = little_scene_new();
		little_ground(s);
		little_object *o = little_box(s, 500, ob_v3(.5, .5, .25), ob_v3(0, 0, .25));
		o->state.v = ob_v3(3 * cos(heading), 3 * sin(heading), 0);
		little_universe l;
		little_open(&l, s);
		little_run_to(&l, 1);
		ob_state end = little_state(&l, 1);
		double way = hypot(end.pose.p.x, end.pose.p.y);
		CHECK_NEAR(ob_norm(end.v), 0, 1e-6);
		CHECK_NEAR(atan2(end.pose.p.y, end.pose.p.x), remainder(heading, 2 * M_PI), 1e-3);
		least = fmin(least, way);
		most = fmax(most, way);
		little_close(&l);
		free(s);
	}
	printf("sliding: off by %.2e .. %.2e\n", least / exact - 1, most / exact - 1);
	CHECK_NEAR(least / exact, 1, .001);
	CHECK_NEAR(most / exact, 1, .001);
}

// 7 m/s, mu = .2: it slides until t = 2 v / (7 mu g), then rolls at 5/7 of its speed.
static void test_slip_to_roll(void)
{
	little_scene *s = little_scene_new();
	little_ground(s)->passport.friction = .2;
	little_object *o = little_sphere(s, 10, .5, ob_v3(0, 0, .5));
	o->passport.friction = .2;
	o->state.v.x = 7;
	little_universe l;
	little_open(&l, s);
	double rolls = 14 / (7 * .2 * g), t = 0;
	ob_state b = little_state(&l, 1);
	while (fabs(b.v.x - b.w.y * .5) > 1e-3 * 7 && t < 2) {
		little_run(&l, 1);
		t = ob_step_count(l.u) / 60.;
		b = little_state(&l, 1);
		if (t < rolls - .02)
			CHECK_NEAR(b.v.x, 7 - .2 * g * t, .005);
	}
	CHECK_NEAR(t, rolls, 1.01 / 60);
	little_run_to(&l, 3);
	b = little_state(&l, 1);
	printf("rolling: off by %.2e\n", b.v.x / 5 - 1);
	CHECK_NEAR(b.v.x, 5, .005);
	CHECK_NEAR(b.pose.p.x, 7 * rolls - .1 * g * rolls * rolls + 5 * (3 - rolls), .02);
	little_close(&l);
	free(s);
}

// Rolls above (2/7) tan of the angle, slides below.
static void ball_on_incline(double mu, double a)
{
	double angle = 20 * M_PI / 180, time = 2;
	little_scene *s = little_scene_new();
	slope i = incline(angle);
	little_object *o = little_ground(s);
	o->state.pose.q = i.q;
	o->passport.friction = mu;
	o = little_sphere(s, 10, .5, ob_scale(i.normal, .5));
	o->passport.friction = mu;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	double v = ob_dot(i.down, little_state(&l, 1).v);
	printf("ball on incline, mu %g: off by %.2e\n", mu, v / (a * time) - 1);
	CHECK_NEAR(v / (a * time), 1, .001);
	little_close(&l);
	free(s);
}

int main(void)
{
	double angle = 20 * M_PI / 180;
	test_incline();
	test_isotropic();
	test_slip_to_roll();
	ball_on_incline(.3, 5. / 7 * g * sin(angle));
	ball_on_incline(.05, g * (sin(angle) - .05 * cos(angle)));
	return check_end();
}
