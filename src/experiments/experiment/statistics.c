#include "experiment/statistics.h"

#include <math.h>
#include <stdlib.h>

static const double confidence = .95;

// Probability of |T| < t. The series is finite for whole degrees of freedom.
static double student_within(int freedom, double t)
{
	double angle = atan(t / sqrt(freedom)), c = cos(angle), term = freedom % 2 ? c : 1, sum = 0;
	for (int k = freedom % 2 ? 3 : 2; k <= freedom; k += 2) {
		sum += term;
		term *= c * c * (k - 1) / k;
	}
	return freedom % 2 ? 2 / M_PI * (angle + sin(angle) * sum) : sin(angle) * sum;
}

double ob_statistics_student(int freedom, double p)
{
	double low = 0, high = 1;
	while (student_within(freedom, high) < p)
		high *= 2;
	for (int i = 0; i < 200; i++) {
		double t = .5 * (low + high);
		if (student_within(freedom, t) < p)
			low = t;
		else
			high = t;
	}
	return .5 * (low + high);
}

static int ascending(const void *x, const void *y)
{
	double a = *(const double *)x, b = *(const double *)y;
	return a < b ? -1 : a > b;
}

// Number of values at each end outside the interval of the median: the largest k such that at most k of n fair coins
// show heads with a probability up to half of the rest; -1 if there is none.
static long outside(size_t n)
{
	double each = exp(-(double)n * M_LN2), sum = 0;
	long k = -1;
	for (size_t i = 0; i < n; i++) {
		sum += each;
		if (sum > .5 * (1 - confidence))
			break;
		k = (long)i;
		each *= (double)(n - i) / (double)(i + 1);
	}
	return k;
}

static double mean_of(size_t n, const double *x)
{
	double sum = 0;
	for (size_t i = 0; i < n; i++)
		sum += x[i];
	return sum / (double)n;
}

static double deviation_of(size_t n, const double *x, double mean)
{
	double squares = 0;
	for (size_t i = 0; i < n; i++)
		squares += (x[i] - mean) * (x[i] - mean);
	return sqrt(squares / (double)(n - 1));
}

ob_statistics ob_statistics_summarise(size_t n, double *x)
{
	ob_statistics s = { n, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN };
	if (n == 0)
		return s;
	s.mean = mean_of(n, x);
	if (isnan(s.mean)) // infinities of both signs, or NaN
		return s;
	qsort(x, n, sizeof *x, ascending);
	s.least = x[0];
	s.most = x[n - 1];
	s.median = n % 2 ? x[n / 2] : .5 * (x[n / 2 - 1] + x[n / 2]);
	if (n >= 2) {
		s.deviation = deviation_of(n, x, s.mean);
		double half = ob_statistics_student((int)n - 1, confidence) * s.deviation / sqrt((double)n);
		s.mean_low = s.mean - half;
		s.mean_high = s.mean + half;
	}
	long k = outside(n);
	if (k >= 0) {
		s.median_low = x[k];
		s.median_high = x[n - 1 - (size_t)k];
	}
	return s;
}

ob_line ob_statistics_line(size_t n, const double *x, const double *y)
{
	ob_line l = { n, NAN, NAN, NAN, NAN, NAN, NAN };
	double mean_x = 0, mean_y = 0, xx = 0, xy = 0, squares = 0;
	if (n < 2)
		return l;
	for (size_t i = 0; i < n; i++) {
		mean_x += x[i] / (double)n;
		mean_y += y[i] / (double)n;
	}
	for (size_t i = 0; i < n; i++) {
		xx += (x[i] - mean_x) * (x[i] - mean_x);
		xy += (x[i] - mean_x) * (y[i] - mean_y);
	}
	if (!(xx > 0))
		return l;
	l.mean_y = mean_y;
	l.slope = xy / xx;
	l.intercept = mean_y - l.slope * mean_x;
	for (size_t i = 0; i < n; i++)
		squares += pow(y[i] - l.intercept - l.slope * x[i], 2);
	l.squares = squares;
	if (n < 3)
		return l;
	double half = ob_statistics_student((int)n - 2, confidence) * sqrt(squares / (double)(n - 2) / xx);
	l.slope_low = l.slope - half;
	l.slope_high = l.slope + half;
	return l;
}

double ob_statistics_order(size_t n, const double *h, const double *error, double floor)
{
	double points = 0, x = 0, y = 0, xx = 0, xy = 0;
	for (size_t i = 0; i < n; i++) {
		if (!(error[i] > floor) || !isfinite(error[i]))
			continue;
		double lh = log(h[i]), le = log(error[i]);
		points++;
		x += lh;
		y += le;
		xx += lh * lh;
		xy += lh * le;
	}
	return points < 2 ? NAN : (points * xy - x * y) / (points * xx - x * x);
}
