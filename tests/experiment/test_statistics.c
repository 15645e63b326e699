// Means, medians and their intervals against tables and by drawing many samples; lines against a published example;
// orders of convergence of quadrature rules with known order.
#include "experiment/analysis.h"

#include "check.h"
#include "motion/random.h"

// Student's table as printed in Abramowitz and Stegun 1964, 26.10; and the density, integrated by Simpson's rule.
static void test_student(void)
{
	CHECK_NEAR(ob_statistics_student(1, .95), 12.706, 5e-4);
	CHECK_NEAR(ob_statistics_student(2, .95), 4.303, 5e-4);
	CHECK_NEAR(ob_statistics_student(4, .95), 2.776, 5e-4);
	CHECK_NEAR(ob_statistics_student(19, .95), 2.093, 5e-4);
	CHECK_NEAR(ob_statistics_student(19, .99), 2.861, 5e-4);
	CHECK_NEAR(ob_statistics_student(1000, .95), 1.962, 5e-4);
	for (int freedom = 1; freedom < 40; freedom += 3) {
		double t = ob_statistics_student(freedom, .9), sum = 0, h = t / 1000;
		double scale = exp(lgamma(.5 * (freedom + 1)) - lgamma(.5 * freedom)) / sqrt(freedom * M_PI);
		for (int i = 0; i <= 1000; i++) {
			double density = scale * pow(1 + i * h * (i * h) / freedom, -.5 * (freedom + 1));
			sum += density * (i == 0 || i == 1000 ? 1 : i % 2 ? 4 : 2) * h / 3;
		}
		CHECK_NEAR(2 * sum, .9, 1e-9);
	}
}

static void test_small(void)
{
	double x[] = { 4, 1, 3, 2 };
	ob_statistics s = ob_statistics_summarise(4, x);
	CHECK(s.n == 4 && s.mean == 2.5 && s.median == 2.5 && s.least == 1 && s.most == 4);
	CHECK_NEAR(s.deviation, sqrt(5. / 3), 1e-15);
	CHECK_NEAR(s.mean_high - s.mean, 3.18245 * sqrt(5. / 12), 1e-5);
	CHECK_NEAR(s.mean - s.mean_low, s.mean_high - s.mean, 1e-15);
	CHECK(isnan(s.median_low));
	s = ob_statistics_summarise(1, x);
	CHECK(s.mean == 1 && s.median == 1 && isnan(s.deviation) && isnan(s.mean_low));
	CHECK(isnan(ob_statistics_summarise(0, x).mean));
	double broken[] = { 1, NAN, 2 };
	CHECK(isnan(ob_statistics_summarise(3, broken).mean) && isnan(ob_statistics_summarise(3, broken).median));
	double failed[] = { 1, INFINITY, 2 };
	s = ob_statistics_summarise(3, failed);
	CHECK(s.median == 2 && isinf(s.mean) && isinf(s.most));
}

// The interval of the median of 20 runs from the 6th to the 15th value, of 6 from the first to the last (Thompson's
// table).
static void test_median_interval(void)
{
	double x[20];
	for (int i = 0; i < 20; i++)
		x[i] = (i * 7) % 20 + 1;
	ob_statistics s = ob_statistics_summarise(20, x);
	CHECK(s.median_low == 6 && s.median_high == 15 && s.median == 10.5);
	double six[] = { 6, 5, 4, 3, 2, 1 };
	s = ob_statistics_summarise(6, six);
	CHECK(s.median_low == 1 && s.median_high == 6);
}

// Coverage of the intervals: 95 % for the mean of normal values, at least 95 % for the median of any.
static void test_coverage(void)
{
	enum { TRIALS = 4000, N = 12 };
	uint64_t seed = 11;
	int mean = 0, median = 0;
	for (int t = 0; t < TRIALS; t++) {
		double x[N];
		for (int i = 0; i < N; i++)
			x[i] = sqrt(-2 * log(within(&seed, 1e-300, 1))) * cos(within(&seed, 0, 2 * M_PI));
		ob_statistics s = ob_statistics_summarise(N, x);
		mean += s.mean_low <= 0 && 0 <= s.mean_high;
		for (int i = 0; i < N; i++)
			x[i] = pow(within(&seed, 0, 1), 5); // median 1/32
		s = ob_statistics_summarise(N, x);
		median += s.median_low <= 1. / 32 && 1. / 32 <= s.median_high;
	}
	CHECK_NEAR((double)mean / TRIALS, .95, .012);
	CHECK((double)median / TRIALS > .94);
	CHECK((double)median / TRIALS < .99);
}

// ---- lines

// Anscombe 1973, "Graphs in statistical analysis", first set: slope .500 with a standard error of .118, intercept 3.00,
// residual sum of squares 13.75
static void test_anscombe(void)
{
	static const double x[] = { 10, 8, 13, 9, 11, 14, 6, 4, 12, 7, 5 };
	static const double y[] = { 8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68 };
	ob_line l = ob_statistics_line(11, x, y);
	CHECK(l.n == 11);
	CHECK_NEAR(l.slope, .500, .0005);
	CHECK_NEAR(l.intercept, 3.00, .005);
	CHECK_NEAR(l.squares, 13.763, .001);
	CHECK_NEAR(l.mean_y, 7.5009, 1e-4);
	// 2.262 = t of 9 degrees of freedom
	CHECK_NEAR(l.slope_high - l.slope, 2.262 * .1179, 2e-4);
	CHECK_NEAR(l.slope - l.slope_low, 2.262 * .1179, 2e-4);
}

static void test_line_exact(void)
{
	static const double x[] = { 1, 2, 3, 4 }, y[] = { 5, 3, 1, -1 };
	ob_line l = ob_statistics_line(4, x, y);
	CHECK_NEAR(l.slope, -2, 1e-14);
	CHECK_NEAR(l.intercept, 7, 1e-14);
	CHECK_NEAR(l.squares, 0, 1e-24);
	CHECK_NEAR(l.slope_low, -2, 1e-11);
}

static void test_line_too_short(void)
{
	static const double x[] = { 2, 2, 2 }, y[] = { 1, 2, 3 };
	CHECK(isnan(ob_statistics_line(3, x, y).slope));
	CHECK(isnan(ob_statistics_line(1, x, y).slope));
	CHECK(isnan(ob_statistics_line(0, x, y).slope));
	static const double two[] = { 1, 2 };
	ob_line l = ob_statistics_line(2, two, y);
	CHECK_NEAR(l.slope, 1, 1e-14);
	CHECK(isnan(l.slope_low) && isnan(l.slope_high));
}

// ---- orders of convergence

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
	double exact = exp(1) - 1, h[RUNS], error[RUNS];
	const int twice[RUNS] = { 4, 8, 16, 32, 64, 128 }, uneven[RUNS] = { 4, 6, 11, 17, 31, 48 };
	for (int order = 1; order <= 4; order *= 2)
		for (int k = 0; k < 2; k++) {
			for (int i = 0; i < RUNS; i++) {
				h[i] = 1. / (k ? uneven : twice)[i];
				error[i] = fabs(quadrature(order, (k ? uneven : twice)[i]) - exact);
			}
			CHECK_NEAR(ob_statistics_order(RUNS, h, error, 1e-14), order, .05);
		}
}

// No order is reported if rounding dominates the error.
static void test_no_order(void)
{
	const double h[3] = { 1, .5, .25 }, error[3] = { 2, 2, 2 };
	CHECK(isnan(ob_statistics_order(3, h, error, 5)));
	CHECK(isnan(ob_statistics_order(0, h, error, 0)));
}

int main(void)
{
	test_student();
	test_small();
	test_median_interval();
	test_coverage();
	test_anscombe();
	test_line_exact();
	test_line_too_short();
	test_quadrature();
	test_no_order();
	return check_end();
}
