// Sliding and spinning plates against brute force over the surface, and against known results.
#include "reference/plate.h"

#include "check.h"

static const double g = 9.81;

// Midpoints of a grid of 1000 x 1000.
static void brute(const ob_reference_plate *p, double vx, double vy, double w, double *ax, double *ay, double *turn)
{
	enum { N = 1000 };
	double hx = p->half_x, hy = p->disc ? p->half_x : p->half_y, area = 0, moment = 0;
	*ax = *ay = *turn = 0;
	for (int i = 0; i < N; i++) {
		for (int j = 0; j < N; j++) {
			double x = hx * ((2 * i + 1.) / N - 1), y = hy * ((2 * j + 1.) / N - 1);
			if (p->disc && x * x + y * y > hx * hx)
				continue;
			double sx = vx - w * y, sy = vy + w * x, s = hypot(sx, sy);
			area++;
			moment += x * x + y * y;
			*ax -= sx / s;
			*ay -= sy / s;
			*turn -= (x * sy - y * sx) / s;
		}
	}
	*ax *= p->mu * g / area;
	*ay *= p->mu * g / area;
	*turn *= p->mu * g / moment;
}

static void test_friction(ob_reference_plate p, double vx, double vy, double w)
{
	double ax, ay, turn, bx, by, bturn;
	ob_reference_plate_friction(&p, vx, vy, w, &ax, &ay, &turn);
	brute(&p, vx, vy, w, &bx, &by, &bturn);
	CHECK_NEAR(ax, bx, 5e-4);
	CHECK_NEAR(ay, by, 5e-4);
	CHECK_NEAR(turn, bturn, 5e-3);
}

// The closed form of a rectangle and the sum from afar agree at the change from one to the other.
static void test_take_over(void)
{
	ob_reference_plate p = { false, .5, .1, .3, g };
	double a[3], b[3], w = 1, v = 4 * hypot(.5, .1);
	ob_reference_plate_friction(&p, .6 * v * (1 - 1e-9), .8 * v * (1 - 1e-9), w, &a[0], &a[1], &a[2]);
	ob_reference_plate_friction(&p, .6 * v * (1 + 1e-9), .8 * v * (1 + 1e-9), w, &b[0], &b[1], &b[2]);
	for (int i = 0; i < 3; i++)
		CHECK_NEAR(a[i], b[i], 1e-7);
}

static void test_slides(void)
{
	ob_reference_plate square = { false, .4, .4, .25, g }, disc = { true, .4, 0, .25, g };
	ob_reference_plate_state start = { .vx = 2 }, end = ob_reference_plate_slide(&square, start, 10);
	CHECK_NEAR(end.x, 4 / (2 * .25 * g), 1e-7);
	CHECK(end.vx == 0 && fabs(end.y) < 1e-9 && fabs(end.angle) < 1e-9);
	// turning alone: 2/3 mu m g radius of friction against m radius^2 / 2
	end = ob_reference_plate_slide(&disc, (ob_reference_plate_state){ .w = 5 }, 10);
	CHECK_NEAR(end.angle, 25 / (2 * 4. / 3 * .25 * g / .4), 1e-6);
	// the final ratio, from any start
	for (int i = 0; i < 3; i++) {
		static const double v[] = { .5, 2, 4 };
		double t = 10, ratio = 0;
		for (double step = 5; step > 1e-5; step *= .5) {
			start = (ob_reference_plate_state){ .vx = v[i], .w = 5 };
			end = ob_reference_plate_slide(&disc, start, t);
			if (end.w > 0)
				ratio = end.vx / (end.w * .4);
			t += end.w > 0 ? step : -step;
		}
		CHECK_NEAR(ratio, OB_REFERENCE_DISC_END, 1e-2);
	}
}

int main(void)
{
	test_friction((ob_reference_plate){ false, .4, .2, .25, g }, .3, .4, 2);
	test_friction((ob_reference_plate){ false, .5, .05, .25, g }, 1, -2, -3);
	test_friction((ob_reference_plate){ false, .5, .05, .25, g }, 2, 7, .1);
	test_friction((ob_reference_plate){ true, .4, 0, .25, g }, .1, .2, 2);
	test_friction((ob_reference_plate){ true, .4, 0, .25, g }, 1, -.5, 2);
	test_take_over();
	test_slides();
	return check_end();
}
