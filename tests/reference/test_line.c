#include "../check.h"
#include "reference/line.h"

// Anscombe 1973, "Graphs in statistical analysis", first set: slope .500 with a standard error of .118, intercept 3.00,
// residual sum of squares 13.75
static void test_anscombe(void)
{
	static const double x[] = { 10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5 };
	static const double y[] = { 8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68 };
	ob_line l = ob_reference_line(11, x, y);
	CHECK(l.n == 11);
	CHECK_NEAR(l.slope, .500, .0005);
	CHECK_NEAR(l.intercept, 3.00, .005);
	CHECK_NEAR(l.squares, 13.763, .001);
	CHECK_NEAR(l.mean_y, 7.5009, 1e-4);
	// 2.262 = t of 9 degrees of freedom
	CHECK_NEAR(l.slope_high - l.slope, 2.262 * .1179, 2e-4);
	CHECK_NEAR(l.slope - l.slope_low, 2.262 * .1179, 2e-4);
}

static void test_exact(void)
{
	static const double x[] = { 1, 2, 3, 4 }, y[] = { 5, 3, 1, -1 };
	ob_line l = ob_reference_line(4, x, y);
	CHECK_NEAR(l.slope, -2, 1e-14);
	CHECK_NEAR(l.intercept, 7, 1e-14);
	CHECK_NEAR(l.squares, 0, 1e-24);
	CHECK_NEAR(l.slope_low, -2, 1e-11);
}

static void test_too_little(void)
{
	static const double x[] = { 2, 2, 2 }, y[] = { 1, 2, 3 };
	CHECK(isnan(ob_reference_line(3, x, y).slope));
	CHECK(isnan(ob_reference_line(1, x, y).slope));
	CHECK(isnan(ob_reference_line(0, x, y).slope));
	static const double two[] = { 1, 2 };
	ob_line l = ob_reference_line(2, two, y);
	CHECK_NEAR(l.slope, 1, 1e-14);
	CHECK(isnan(l.slope_low) && isnan(l.slope_high));
}

int main(void)
{
	test_anscombe();
	test_exact();
	test_too_little();
	return check_end();
}
