// Orders and limits of quadrature rules, whose own are known, and of made-up sequences.
#include "reference/convergence.h"

#include "check.h"

enum { RUNS = 6 };

// The integral of exp over [0, 1] by a rule of order 1, 2 or 4 with n steps.
static double quadrature(int order, int n)
{
	double h = 1. / n, sum = 0;
	for (int i = 0; i < n; i++) {
		double left = exp(i * h), middle = exp((i + .5) * h), right = exp((i + 1) * h);
		sum += h * (order == 1 ? left : order == 2 ? .5 * (left + right) : (left + 4 * middle + right) / 6);
	}
	return sum;
}

static void test_quadrature(void)
{
	double exact = exp(1) - 1, h[RUNS], value[RUNS], error[RUNS];
	const int twice[RUNS] = { 4, 8, 16, 32, 64, 128 }, uneven[RUNS] = { 4, 6, 11, 17, 31, 48 };
	for (int order = 1; order <= 4; order *= 2)
		for (int k = 0; k < 2; k++) {
			for (int i = 0; i < RUNS; i++) {
				h[i] = 1. / (k ? uneven : twice)[i];
				value[i] = quadrature(order, (k ? uneven : twice)[i]);
				error[i] = fabs(value[i] - exact);
			}
			ob_convergence c = ob_reference_converge(RUNS, h, value);
			CHECK(c.valid);
			CHECK_NEAR(c.order, order, .05);
			CHECK_NEAR(c.error / error[RUNS - 1], 1, .05);
			CHECK_NEAR(c.limit, exact, .05 * error[RUNS - 1]);
			CHECK_NEAR(ob_reference_order(RUNS, h, error, 1e-14), order, .05);
		}
}

static void test_made_up(void)
{
	const double h[4] = { 1, .5, .25, .125 };
	double value[4];
	for (int i = 0; i < 4; i++)
		value[i] = 7 - 3 * pow(h[i], 2.5);
	ob_convergence c = ob_reference_converge(4, h, value);
	CHECK(c.valid);
	CHECK_NEAR(c.order, 2.5, 1e-9);
	CHECK_NEAR(c.limit, 7, 1e-12);
	CHECK_NEAR(c.error, 3 * pow(.125, 2.5), 1e-10);
	CHECK_NEAR(c.agreement, 3 * (pow(.25, 2.5) - pow(.125, 2.5)), 1e-12);
}

// No order is claimed for what swings, stands still, grows, or is too short.
static void test_invalid(void)
{
	const double h[3] = { 1, .5, .25 };
	const double swings[3] = { 1, 2, 1.5 }, stands[3] = { 2, 2, 2 }, grows[3] = { 1, 2, 4 },
		     broken[3] = { 1, NAN, 2 };
	CHECK(!ob_reference_converge(3, h, swings).valid && isnan(ob_reference_converge(3, h, swings).order));
	CHECK(ob_reference_converge(3, h, swings).agreement == .5);
	CHECK(!ob_reference_converge(3, h, stands).valid && ob_reference_converge(3, h, stands).agreement == 0);
	CHECK(!ob_reference_converge(3, h, grows).valid);
	CHECK(!ob_reference_converge(3, h, broken).valid);
	CHECK(!ob_reference_converge(2, h, grows).valid);
	CHECK(isnan(ob_reference_order(3, h, stands, 5)));
	CHECK(isnan(ob_reference_order(0, h, stands, 0)));
}

static void test_serves(void)
{
	const double value[3] = { 5, 1.01, 1 };
	CHECK(ob_reference_serves(3, value, .11));
	CHECK(!ob_reference_serves(3, value, .09));
	CHECK(!ob_reference_serves(1, value, 1e9));
	CHECK(!ob_reference_serves(2, (const double[]){ 1, NAN }, 1));
}

int main(void)
{
	test_quadrature();
	test_made_up();
	test_invalid();
	test_serves();
	return check_end();
}
