// Hard cases of dry friction: stick and slip on an incline, sliding the same way in every direction, a ball that slides
// until it rolls, a ball on an incline.
#include <stdlib.h>

#include "check.h"
#include "little_universe.h"
#include "reference/mechanics.h"

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
	double friction = ob_reference_friction_angle(.5), steep = 1.01 * friction;
	double creep = slid(.99 * friction, 10), exact = .5 * ob_reference_incline(g, steep, .5) * 16,
	       way = slid(steep, 4);
	printf("incline: creep %.2e mm, slide off by %.2e\n", 1e3 * creep, way / exact - 1);
	CHECK_NEAR(creep, 0, 1e-5);
	CHECK_NEAR(way / exact, 1, .003);
}

// When a speed that falls evenly gets to zero, from two looks at it, h apart, the second one at time t.
static double zero_of(double before, double now, double h, double t)
{
	return t + h * now / (before - now);
}

typedef struct range {
	double least, most;
} range;

static void widen(range *r, double x)
{
	r->least = fmin(r->least, x);
	r->most = fmax(r->most, x);
}

// One block sliding at 3 m/s in this direction (rad): way and time to rest over those of the reference.
static void slide(double heading, range *way, range *time)
{
	const double h = 1. / 60;
	double t = 0, before = 0, now = 3;
	little_scene *s = little_scene_new();
	little_ground(s);
	little_object *o = little_box(s, 500, ob_v3(.5, .5, .25), ob_v3(0, 0, .25));
	o->state.v = ob_v3(3 * cos(heading), 3 * sin(heading), 0);
	little_universe l;
	little_open(&l, s);
	while (t < 1) {
		little_run(&l, 1);
		double next = ob_norm(little_state(&l, 1).v);
		if (next > 1e-6)
			t += h, before = now, now = next;
		else
			break;
	}
	widen(time, zero_of(before, now, h, t) / ob_reference_stop_time(3, .5, g));
	little_run_to(&l, 1);
	ob_state end = little_state(&l, 1);
	widen(way, hypot(end.pose.p.x, end.pose.p.y) / ob_reference_stop_distance(3, .5, g));
	CHECK_NEAR(ob_norm(end.v), 0, 1e-6);
	CHECK_NEAR(remainder(atan2(end.pose.p.y, end.pose.p.x) - heading, 2 * M_PI), 0, 1e-3);
	little_close(&l);
	free(s);
}

// Twelve headings: the same way and the same time to rest.
static void test_isotropic(void)
{
	range way = { INFINITY, 0 }, time = { INFINITY, 0 };
	for (int i = 0; i < 12; i++)
		slide(i * M_PI / 6 + .1, &way, &time);
	printf("sliding: way off by %.2e .. %.2e, time by %.2e .. %.2e\n", way.least - 1, way.most - 1, time.least - 1,
	       time.most - 1);
	CHECK_NEAR(way.least, 1, .001);
	CHECK_NEAR(way.most, 1, .001);
	CHECK_NEAR(way.most - way.least, 0, .001);
	CHECK_NEAR(time.least, 1, .001);
	CHECK_NEAR(time.most, 1, .001);
}

// 7 m/s, mu = .2: it slides until 1.0194 s, then rolls at 5/7 of its speed.
static void test_slip_to_roll(void)
{
	const double v = 7, mu = .2, h = 1. / 60;
	little_scene *s = little_scene_new();
	little_ground(s)->passport.friction = mu;
	little_object *o = little_sphere(s, 10, .5, ob_v3(0, 0, .5));
	o->passport.friction = mu;
	o->state.v.x = v;
	little_universe l;
	little_open(&l, s);
	double t = 0, slip = v, before = v, now = v;
	while (slip > 1e-3 * v && t < 2) {
		little_run(&l, 1);
		ob_state b = little_state(&l, 1);
		ob_reference_roll exact = ob_reference_slip_to_roll(v, mu, g, t + h);
		CHECK_NEAR(b.v.x / exact.speed, 1, .001);
		CHECK_NEAR(b.pose.p.x / exact.way, 1, .001);
		slip = b.v.x - b.w.y * .5;
		if (slip > 1e-3 * v)
			t += h, before = now, now = slip;
	}
	double rolls = zero_of(before, now, h, t);
	CHECK_NEAR(rolls / ob_reference_roll_time(v, mu, g), 1, .001);
	little_run_to(&l, 3);
	ob_state b = little_state(&l, 1);
	ob_reference_roll exact = ob_reference_slip_to_roll(v, mu, g, 3);
	printf("rolling: from %.4f s, speed off by %.2e, way by %.2e\n", rolls, b.v.x / exact.speed - 1,
	       b.pose.p.x / exact.way - 1);
	CHECK_NEAR(b.v.x / exact.speed, 1, .001);
	CHECK_NEAR(b.w.y * .5 / exact.surface, 1, .001);
	CHECK_NEAR(b.pose.p.x / exact.way, 1, .001);
	little_close(&l);
	free(s);
}

// Rolls above (2/7) tan of the angle, slides below; "share" of that friction.
static void ball_on_incline(double share)
{
	double angle = 20 * M_PI / 180, time = 2, mu = share * ob_reference_ball_grip(angle);
	double a = ob_reference_ball_incline(g, angle, mu);
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
	ob_state b = little_state(&l, 1);
	double v = ob_dot(i.down, b.v), way = ob_dot(i.down, ob_sub(b.pose.p, o->state.pose.p));
	printf("ball on incline, %g of the friction: speed off by %.2e, way by %.2e\n", share, v / (a * time) - 1,
	       way / (.5 * a * time * time) - 1);
	CHECK_NEAR(v / (a * time), 1, .001);
	CHECK_NEAR(way / (.5 * a * time * time), 1, .001);
	CHECK_NEAR(ob_norm(b.w) * .5 / fmin(v, 2.5 * mu * g * cos(angle) * time), 1, .001);
	little_close(&l);
	free(s);
}

int main(void)
{
	test_incline();
	test_isotropic();
	test_slip_to_roll();
	ball_on_incline(2);
	ball_on_incline(1.02);
	ball_on_incline(.98);
	ball_on_incline(.5);
	return check_end();
}
