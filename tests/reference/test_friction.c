// Friction against the equations of motion, integrated in small steps with the contact's friction found anew in each.
#include "reference/friction.h"

#include "check.h"

static const double g = 9.81, r = .37, m = 2.3; // m/s^2, m, kg

typedef struct ball {
	double x, v, spin; // m, m/s, rad/s
} ball;

// What friction does within h: it brings the slip to nothing if it can, else it pushes with all it has.
static void rub(ball *b, double pull, double normal, double mu, double h)
{
	double inertia = .4 * m * r * r, slip = b->v + h * pull / m - b->spin * r;
	double need = -slip / (h * (1 / m + r * r / inertia)), most = mu * normal;
	double f = fmin(fmax(need, -most), most), before = b->v;
	b->v += h * (pull + f) / m;
	b->spin -= h * f * r / inertia;
	b->x += .5 * h * (b->v + before);
}

static void test_slip_to_roll(void)
{
	const double h = 1e-5, v = 7, mu = .2;
	ball b = { 0, v, 0 };
	CHECK_NEAR(ob_reference_roll_time(v, mu, g), 1.0194, 5e-5);
	CHECK(ob_reference_roll_speed(v) == 5);
	for (int i = 0; i < 200000; i++) {
		if (i % 5000 == 0) {
			ob_reference_roll at = ob_reference_slip_to_roll(v, mu, g, i * h);
			CHECK_NEAR(b.v, at.speed, 1e-4);
			CHECK_NEAR(b.spin * r, at.surface, 1e-4);
			CHECK_NEAR(b.x, at.way, 1e-4);
			// the line of contact keeps its angular momentum
			CHECK_NEAR(at.speed + .4 * at.surface, v, 1e-12);
		}
		rub(&b, 0, m * g, mu, h);
	}
}

static void test_slopes(void)
{
	for (int i = 0; i < 40; i++) {
		double angle = .02 + .03 * i, grip = ob_reference_ball_grip(angle);
		double mu = grip * (i % 2 ? 1.05 : .95), h = 1e-4;
		ball b = { 0, 0, 0 };
		for (int k = 0; k < 10000; k++)
			rub(&b, m * g * sin(angle), m * g * cos(angle), mu, h);
		double a = ob_reference_ball_incline(g, angle, mu);
		CHECK_NEAR(b.v, a, 1e-8 * g);
		CHECK_NEAR(b.spin * r, i % 2 ? a : 2.5 * mu * g * cos(angle), 1e-8 * g);
		// a block: no spin to take
		double sticks = ob_reference_friction_angle(.5);
		CHECK_NEAR(tan(sticks), .5, 1e-15);
		CHECK(ob_reference_incline(g, sticks * .999, .5) == 0 &&
		      ob_reference_incline(g, sticks * 1.001, .5) > 0);
		CHECK_NEAR(ob_reference_incline(g, angle, 0), g * sin(angle), 1e-12);
	}
	CHECK_NEAR(ob_reference_incline(g, M_PI / 2, .5), g, 1e-12);
	CHECK_NEAR(ob_reference_incline(10, asin(.6), .25), 6 - 2, 1e-14);
}

static void test_stopping(void)
{
	CHECK_NEAR(ob_reference_stop_distance(3, .5, g), .91743, 5e-6);
	CHECK_NEAR(ob_reference_stop_time(3, .5, g), .61162, 5e-6);
	double v = 4.2, x = 0, h = 1e-6, t = 0, mu = .3;
	for (; v > 0; t += h) {
		x += h * (v - .5 * h * mu * g);
		v -= h * mu * g;
	}
	CHECK_NEAR(ob_reference_stop_distance(4.2, mu, g), x, 1e-8);
	CHECK_NEAR(ob_reference_stop_time(4.2, mu, g), t, 2e-6);
}

// The equations of box and spheres, one by one; and the rows of the specification.
static void test_push(void)
{
	ob_reference_rolling p = ob_reference_push(150, .4, 10, 1, 25, g);
	CHECK_NEAR(p.box_a, .7385, 5e-5);
	CHECK_NEAR(p.ball_a, .2110, 5e-5);
	for (int n = 0; n <= 30; n += 3) {
		p = ob_reference_push(200, .3, 8, m, n, g);
		double inertia = .4 * m * r * r;
		CHECK_NEAR(8 * p.box_a, 200 - p.ground - n * p.ball, 1e-11);
		CHECK_NEAR(p.ground, .3 * (8 + n * m) * g, 1e-11);
		CHECK_NEAR(m * p.ball_a, p.ball, 1e-12);
		CHECK_NEAR(p.ball_a + p.ball * r / inertia * r, p.box_a, 1e-12); // the lowest point keeps up
		CHECK_NEAR(p.grip * m * g, p.ball, 1e-12);
	}
	CHECK_NEAR(ob_reference_push(150, .4, 10, 1, 0, g).box_a, 15 - .4 * g, 1e-12);
}

int main(void)
{
	test_slip_to_roll();
	test_slopes();
	test_stopping();
	test_push();
	return check_end();
}
