// Means, medians and their intervals: against tables, and by drawing many samples.
#include "reference/statistics.h"

#include "check.h"
#include "motion/random.h"

// Student's table as printed in Abramowitz and Stegun 1964, 26.10; and the density, integrated by Simpson's rule.
static void test_student(void)
{
	CHECK_NEAR(ob_reference_student(1, .95), 12.706, 5e-4);
	CHECK_NEAR(ob_reference_student(2, .95), 4.303, 5e-4);
	CHECK_NEAR(ob_reference_student(4, .95), 2.776, 5e-4);
	CHECK_NEAR(ob_reference_student(19, .95), 2.093, 5e-4);
	CHECK_NEAR(ob_reference_student(19, .99), 2.861, 5e-4);
	CHECK_NEAR(ob_reference_student(1000, .95), 1.962, 5e-4);
	for (int freedom = 1; freedom < 40; freedom += 3) {
		double t = ob_reference_student(freedom, .9), sum = 0, h = t / 1000;
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
	ob_statistics s = ob_reference_summarise(4, x);
	CHECK(s.n == 4 && s.mean == 2.5 && s.median == 2.5 && s.least == 1 && s.most == 4);
	CHECK_NEAR(s.deviation, sqrt(5. / 3), 1e-15);
	CHECK_NEAR(s.mean_high - s.mean, 3.18245 * sqrt(5. / 12), 1e-5);
	CHECK_NEAR(s.mean - s.mean_low, s.mean_high - s.mean, 1e-15);
	CHECK(isnan(s.median_low));
	s = ob_reference_summarise(1, x);
	CHECK(s.mean == 1 && s.median == 1 && isnan(s.deviation) && isnan(s.mean_low));
	CHECK(isnan(ob_reference_summarise(0, x).mean));
	double broken[] = { 1, NAN, 2 };
	CHECK(isnan(ob_reference_summarise(3, broken).mean) && isnan(ob_reference_summarise(3, broken).median));
	double failed[] = { 1, INFINITY, 2 };
	s = ob_reference_summarise(3, failed);
	CHECK(s.median == 2 && isinf(s.mean) && isinf(s.most));
}

// The interval of the median of 20 runs from the 6th to the 15th value, of 6 from the first to the last (Thompson's
// table).
static void test_median_interval(void)
{
	double x[20];
	for (int i = 0; i < 20; i++)
		x[i] = (i * 7) % 20 + 1;
	ob_statistics s = ob_reference_summarise(20, x);
	CHECK(s.median_low == 6 && s.median_high == 15 && s.median == 10.5);
	double six[] = { 6, 5, 4, 3, 2, 1 };
	s = ob_reference_summarise(6, six);
	CHECK(s.median_low == 1 && s.median_high == 6);
}

// How often the intervals hold the truth: 95 % for the mean of normal values, at least 95 % for the median of any.
static void test_coverage(void)
{
	enum { TRIALS = 4000, N = 12 };
	uint64_t seed = 11;
	int mean = 0, median = 0;
	for (int t = 0; t < TRIALS; t++) {
		double x[N];
		for (int i = 0; i < N; i++)
			x[i] = sqrt(-2 * log(within(&seed, 1e-300, 1))) * cos(within(&seed, 0, 2 * M_PI));
		ob_statistics s = ob_reference_summarise(N, x);
		mean += s.mean_low <= 0 && 0 <= s.mean_high;
		for (int i = 0; i < N; i++)
			x[i] = pow(within(&seed, 0, 1), 5); // median 1/32
		s = ob_reference_summarise(N, x);
		median += s.median_low <= 1. / 32 && 1. / 32 <= s.median_high;
	}
	CHECK_NEAR((double)mean / TRIALS, .95, .012);
	CHECK((double)median / TRIALS > .94);
	CHECK((double)median / TRIALS < .99);
}

int main(void)
{
	test_student();
	test_small();
	test_median_interval();
	test_coverage();
	return check_end();
}
