// Friction beyond the cases of the lab: a sphere that slides until it rolls, step by step; one on an incline on either
// side of its limit; spheres that roll on a box which is pushed, with a single substep; a slab that spins, with a pebble on it.
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

// Zero of a linearly falling speed, from two samples, h apart, the second one at time t.
static double zero_of(double before, double now, double h, double t)
{
	return t + h * now / (before - now);
}

// 7 m/s, mu = .2: it slides until 1.0194 s, then rolls at 5/7 of its speed.
static void test_slip_to_roll(void)
{
	const double v = 7, mu = .2, h = 1. / 60;
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world).passport->friction = mu;
	ob_world_body o = ob_world_sphere(&s->world, 10, .5, ob_v3(0, 0, .5));
	o.passport->friction = mu;
	o.state->v.x = v;
	little_universe l;
	little_open(&l, s);
	double t = 0, slip = v, before = v, now = v;
	while (slip > 1e-3 * v && t < 2) {
		little_run(&l, 1);
		ob_state b = little_state(&l, 1);
		ob_reference_roll exact = ob_reference_slip_to_roll(v, mu, g, t + h);
		CHECK_NEAR(b.v.x / exact.speed, 1, .001);
		CHECK_NEAR(b.pose.p.x / exact.distance, 1, .001);
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
	       b.pose.p.x / exact.distance - 1);
	CHECK_NEAR(b.v.x / exact.speed, 1, .001);
	CHECK_NEAR(b.w.y * .5 / exact.surface, 1, .001);
	CHECK_NEAR(b.pose.p.x / exact.distance, 1, .001);
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
	ob_world_body o = ob_world_ground(&s->world);
	o.state->pose.q = i.q;
	o.passport->friction = mu;
	o = ob_world_sphere(&s->world, 10, .5, ob_scale(i.normal, .5));
	o.passport->friction = mu;
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, time);
	ob_state b = little_state(&l, 1);
	double v = ob_dot(i.down, b.v), way = ob_dot(i.down, ob_sub(b.pose.p, o.state->pose.p));
	printf("ball on incline, %g of the friction: speed off by %.2e, way by %.2e\n", share, v / (a * time) - 1,
	       way / (.5 * a * time * time) - 1);
	CHECK_NEAR(v / (a * time), 1, .001);
	CHECK_NEAR(way / (.5 * a * time * time), 1, .001);
	CHECK_NEAR(ob_norm(b.w) * .5 / fmin(v, 2.5 * mu * g * cos(angle) * time), 1, .001);
	little_close(&l);
	free(s);
}

// ---- SimBenchmark's rolling test (Kang and Hwangbo 2018): the box is in contact with all 25 spheres, so what is left
// over
// ---- of its velocity in an iteration is left over of theirs

enum { BOX = 1, BALL = 2, BALLS = 25 };
static const double push = 150; // N

// Squared error of the velocity along the push, against the closed form.
static double squared_error(const little_universe *l, uint32_t id, ob_vec3 direction, double a)
{
	double t = l->scene->run.step_length * (double)ob_step_count(l->u);
	return ob_norm2(ob_sub(little_state(l, id).v, ob_scale(direction, a * t)));
}

static little_scene *pushed_box(ob_vec3 direction)
{
	little_scene *s = little_scene_new();
	s->run.substeps = 1;
	ob_world_ground(&s->world).passport->friction = .2; // with the box's .8: .4
	ob_world_body box = ob_world_box(&s->world, 10, ob_v3(10, 10, .5), ob_v3(0, 0, .5 - 2e-5));
	box.passport->friction = .8;
	box.passport->force = ob_scale(direction, push);
	for (int i = 0; i < BALLS; i++)
		ob_world_sphere(&s->world, 1, .5, ob_v3(2 * (i / 5) - 4, 2 * (i % 5) - 4, 1.5 - 6e-5))
			.passport->friction = .8;
	return s;
}

static void test_push(ob_vec3 direction)
{
	const int steps = 240; // 4 s
	ob_reference_rolling exact = ob_reference_push(push, .4, 10, 1, BALLS, 9.81);
	little_scene *s = pushed_box(direction);
	little_universe l;
	little_open(&l, s);
	double error = 0, apart = 0;
	for (int step = 0; step < steps; step++) {
		little_run(&l, 1);
		error += squared_error(&l, BOX, direction, exact.box_a) / steps;
		error += squared_error(&l, BALL, direction, exact.ball_a) / steps;
	}
	for (uint32_t i = BALL; i < BALL + BALLS; i++)
		apart = fmax(apart, ob_norm(ob_sub(little_state(&l, i).v, little_state(&l, BALL).v)));
	printf("along (%.2f, %.2f): mean squared error %.1e m^2/s^2, spheres differ by %.1e m/s\n", direction.x,
	       direction.y, error, apart);
	CHECK(error <= 1e-6);
	CHECK(apart <= 1e-3);
	little_close(&l);
	free(s);
}

// Place (x, y: m) and turn (z: rad) of a slab of 20 kg that has slid and spun for 3 s. A box of "pebble" kg lies on it and
// moves along; 0: none.
static ob_vec3 slab_goes(double pebble, double speed, double spin)
{
	little_scene *s = little_scene_new();
	ob_world_ground(&s->world);
	ob_world_body slab = ob_world_box(&s->world, 20, ob_v3(1, .5, .25), ob_v3(0, 0, .25));
	slab.state->v = ob_v3(speed, 0, 0), slab.state->w = ob_v3(0, 0, spin);
	if (pebble > 0) {
		ob_world_body b = ob_world_box(&s->world, pebble, ob_v3(.1, .1, .1), ob_v3(0, 0, .6));
		b.state->v = ob_v3(speed, 0, 0), b.state->w = ob_v3(0, 0, spin);
	}
	ob_world_material(&s->world, .3, 0);
	little_universe l;
	little_open(&l, s);
	little_run_to(&l, 3);
	const ob_state b = little_state(&l, 1);
	little_close(&l);
	free(s);
	return ob_v3(b.pose.p.x, b.pose.p.y, 2 * atan2(b.pose.q.z, b.pose.q.w));
}

// A body without weight changes nothing. 2e-3 m and rad: friction of a slab that carries another takes its direction once in a
// partial substep, and in the first one has no load to go by.
static void test_pebble(void)
{
	const struct {
		double speed, spin;
	} start[] = { { 3, 8 }, { 3, 0 }, { 1, 4 }, { 2, -12 }, { .5, 6 } };
	for (size_t i = 0; i < sizeof start / sizeof *start; i++)
		for (double pebble = 1e-9; pebble < 1; pebble *= 1e4) {
			const ob_vec3 alone = slab_goes(0, start[i].speed, start[i].spin),
				      with = slab_goes(pebble, start[i].speed, start[i].spin);
			const double aside = hypot(with.x - alone.x, with.y - alone.y),
				     turned = fabs(remainder(with.z - alone.z, 2 * 3.14159265358979324));
			printf("slab at %g m/s and %g rad/s with a pebble of %g kg: %.2e m, %.2e rad\n", start[i].speed,
			       start[i].spin, pebble, aside, turned);
			CHECK(aside <= 2e-3 + 10 * pebble / 20);
			CHECK(turned <= 2e-3 + 20 * pebble / 20);
		}
}

int main(void)
{
	test_slip_to_roll();
	test_pebble();
	ball_on_incline(2);
	ball_on_incline(1.02);
	ball_on_incline(.98);
	ball_on_incline(.5);
	test_push(ob_v3(.5, sqrt(.75), 0));
	test_push(ob_v3(0, 1, 0));
	return check_end();
}
