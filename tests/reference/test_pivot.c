// Bodies that turn about a pivot, against integration in small steps, and against conserved quantities.
#include <ob/vec.h>

#include "reference/pivot.h"
#include "reference/integrator.h"

#include "check.h"

static const double g = 9.81;

// Verlet in steps of 1e-5 s from rest.
static void test_rocker(double half, double height)
{
	ob_reference_rocker r = { half, height, (half * half + height * height) / 3, g };
	double arm2 = half * half + height * height, alpha = atan2(half, height), angle = .5 * alpha, w = 0, t = 0;
	double c = g * sqrt(arm2) / (r.moment + arm2);
	const double h = 1e-5;
	double whole = ob_reference_rocker_time(&r, angle, 0);
	while (angle > 0) {
		w -= .5 * h * c * sin(alpha - angle);
		angle += h * w;
		w -= .5 * h * c * sin(alpha - angle);
		t += h;
		if (t < .5 * whole && t + h >= .5 * whole)
			CHECK_NEAR(t + ob_reference_rocker_time(&r, angle, w), whole, 1e-8);
	}
	CHECK_NEAR(whole, t + angle / -w, 1e-8);
	CHECK_NEAR(ob_reference_rocker_ratio(&r), 1 - 1.5 * sin(alpha) * sin(alpha), 1e-14);
}

// For slender blocks acosh(1 / (1 - angle / alpha)) over the rate (Housner 1963).
static void test_slender(void)
{
	ob_reference_rocker r = { 1e-3, 1, 1. / 3, g };
	CHECK_NEAR(ob_reference_rocker_time(&r, .5e-3, 0), acosh(2) / sqrt(.75 * g), 1e-6);
}

static void test_topple(void)
{
	double d = .0005, z = .1, moment = .08, inertia = moment + d * d + z * z, rate = sqrt(g * z / inertia);
	CHECK_NEAR(ob_reference_topple(d, z, moment, g, .5), d / z * (cosh(.5 * rate) - 1), 1e-6);
}

// The rim does not slip: the lowest point has no velocity, and the moment about the centre turns the momentum.
static void test_disk(void)
{
	double a = .5, h = .025, tilt = .2, w = ob_reference_disk_precession(a, h, tilt, g);
	double spin = ob_reference_disk_spin(a, h, tilt, g), s = sin(tilt), c = cos(tilt);
	ob_vec3 axis = ob_v3(s, 0, c), down = ob_v3(c, 0, -s);
	ob_vec3 arm = ob_madd(ob_scale(down, a), -h, axis), turn = ob_madd(ob_v3(0, 0, w), spin, axis);
	CHECK_NEAR(ob_norm(ob_cross(turn, arm)), 0, 1e-12);
	double across = a * a / 4 + h * h / 3, along = a * a / 2;
	ob_vec3 momentum = ob_madd(ob_scale(down, across * ob_dot(turn, down)), along * ob_dot(turn, axis), axis);
	ob_vec3 rate = ob_cross(ob_v3(0, 0, w), momentum), push = ob_cross(arm, ob_v3(0, 0, g));
	CHECK_NEAR(ob_norm(ob_sub(rate, push)), 0, 1e-12);
	CHECK_NEAR(ob_reference_disk_precession(1, 1e-9, .01, g), sqrt(4 * g / sin(.01)), 1e-4);
}

static void decay(const double *y, double *rate, const void *with)
{
	rate[0] = y[1];
	rate[1] = -y[0];
}

static double square(double x, const void *with)
{
	return x * x;
}

static void test_integrator(void)
{
	ob_reference_system s = { .states = 2, .rate = decay, .tolerance = 1e-12 };
	double y[2] = { 1, 0 };
	CHECK(ob_reference_integrate(&s, 10, y) == 10);
	CHECK_NEAR(y[0], cos(10), 1e-9);
	CHECK_NEAR(ob_reference_quadrature(square, NULL, 1, 4, 3), 21, 1e-13);
}

int main(void)
{
	test_rocker(.25, .5);
	test_rocker(.05, .5);
	test_slender();
	test_topple();
	test_disk();
	test_integrator();
	return check_end();
}
