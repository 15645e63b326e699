// Free fall and bounces against step-by-step integration, and what they conserve.
#include "reference/ballistics.h"

#include "check.h"

static const double g = 9.81; // m/s^2

// The second difference of positions is the acceleration, the first one at t = 0 the speed.
static void test_parabola(void)
{
	ob_vec3 p = ob_v3(1, -2, 3), v = ob_v3(4, 5, -6), a = ob_v3(.5, 1, -g);
	for (int i = 0; i < 20; i++) {
		double t = .3 * i, d = 1e-3;
		ob_vec3 before = ob_reference_parabola(p, v, a, t - d), at = ob_reference_parabola(p, v, a, t);
		ob_vec3 after = ob_reference_parabola(p, v, a, t + d);
		ob_vec3 bend = ob_scale(ob_add(ob_sub(after, at), ob_sub(before, at)), 1 / (d * d));
		ob_vec3 slope = ob_scale(ob_sub(after, before), .5 / d);
		CHECK_NEAR(ob_norm(ob_sub(bend, a)), 0, 1e-6);
		CHECK_NEAR(ob_norm(ob_sub(slope, ob_madd(v, t, a))), 0, 1e-9);
		CHECK_NEAR(.5 * ob_norm2(slope) - ob_dot(a, at), .5 * ob_norm2(v) - ob_dot(a, p), 1e-6); // energy
	}
}

// Follows the ball from impact to impact with nothing but v^2 = 2 g h and v -> e v.
static void follow(double height, double e, int impacts)
{
	long double speed = sqrtl(2 * (long double)g * height), now = speed / g;
	for (int k = 1; k <= impacts; k++) {
		CHECK_NEAR(ob_reference_impact_time(height, g, e, k), (double)now, 1e-13 * (double)now);
		CHECK_NEAR(ob_reference_bounce(height, g, e, (double)now), 0, 1e-12);
		speed *= e;
		double top = (double)(speed * speed / (2 * g)), when = (double)(now + speed / g);
		CHECK_NEAR(ob_reference_apex(height, e, k), top, 1e-13 * height);
		CHECK_NEAR(ob_reference_apex_time(height, g, e, k), when, 1e-13 * when);
		CHECK_NEAR(ob_reference_bounce(height, g, e, when), top, 1e-12);
		double part = .37 * (double)(2 * speed / g), z = (double)speed * part - .5 * g * part * part;
		CHECK_NEAR(ob_reference_bounce(height, g, e, (double)now + part), z, 1e-12);
		now += 2 * speed / g;
	}
}

static void test_bounces(void)
{
	follow(1, 1, 100);
	follow(1, .8, 30);
	follow(3, .5, 12);
	CHECK(ob_reference_apex(1.3, .8, 0) == 1.3 && ob_reference_apex_time(1.3, g, .8, 0) == 0);
	CHECK_NEAR(ob_reference_apex(1, .8, 4), .16777216, 1e-15);
	CHECK_NEAR(ob_reference_bounce(2, g, .5, .1), 2 - .005 * g, 1e-15);
}

// Infinitely many impacts in finite time; without restitution the first is the last.
static void test_rest(void)
{
	double end = 3 * sqrt(2 / g);
	CHECK(ob_reference_bounce(1, g, .5, end) == 0);
	CHECK(ob_reference_bounce(1, g, .5, 100) == 0);
	CHECK(ob_reference_bounce(1, g, .5, .99 * end) >= 0);
	CHECK_NEAR(ob_reference_impact_time(1, g, .5, 60), end, 1e-12);
	CHECK(ob_reference_bounce(1, g, 0, sqrt(2 / g) * 1.001) == 0);
}

int main(void)
{
	test_parabola();
	test_bounces();
	test_rest();
	return check_end();
}
