#include "experiment/analysis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_of(const ob_record *r, const char *of, const char *configuration)
{
	return !strcmp(r->configuration, configuration) && !strcmp(r->of, of);
}

static size_t collect(const ob_records *r, const char *of, const char *configuration, size_t metric,
		      double x[OB_SAMPLES])
{
	size_t n = 0;
	for (size_t i = 0; i < r->count && n < OB_SAMPLES; i++) {
		const ob_record *one = &r->record[i];
		if (!one->failure && is_of(one, of, configuration) && !isnan(one->metric[metric]))
			x[n++] = one->metric[metric];
	}
	return n;
}

ob_statistics ob_records_summarise(const ob_records *r, const char *of, const char *configuration, size_t metric)
{
	double x[OB_SAMPLES];
	const size_t n = collect(r, of, configuration, metric, x);
	return ob_statistics_summarise(n, x);
}

ob_estimate ob_estimate_median(const ob_statistics *s)
{
	const bool interval = !isnan(s->median_low), several = s->n > 1;
	return (ob_estimate){ s->n, s->median,
			      interval  ? s->median_low
			      : several ? s->least
					: NAN,
			      interval  ? s->median_high
			      : several ? s->most
					: NAN,
			      interval };
}

static ob_estimate estimate(const ob_statistics *s, bool logarithms)
{
	enum { LEAST = 3 };
	const bool interval = s->n >= LEAST;
	ob_estimate e = { s->n, s->mean, interval ? s->mean_low : NAN, interval ? s->mean_high : NAN, interval };
	if (logarithms)
		e.value = exp(e.value), e.low = exp(e.low), e.high = exp(e.high);
	return e;
}

ob_estimate ob_records_estimate(const ob_records *r, const char *of, const char *configuration, size_t metric,
				bool geometric)
{
	double x[OB_SAMPLES];
	const size_t n = collect(r, of, configuration, metric, x);
	for (size_t i = 0; i < n; i++)
		geometric &= x[i] > 0 && isfinite(x[i]);
	for (size_t i = 0; geometric && i < n; i++)
		x[i] = log(x[i]);
	const ob_statistics s = ob_statistics_summarise(n, x);
	return estimate(&s, geometric);
}

ob_statistics ob_records_ratio(const ob_records *r, const char *of, const char *a, const char *b, size_t metric,
			       bool logarithm)
{
	double x[OB_SAMPLES];
	size_t n = 0;
	for (size_t i = 0; i < r->count && n < OB_SAMPLES; i++) {
		const ob_record *one = &r->record[i];
		if (one->failure || !is_of(one, of, a))
			continue;
		const ob_record *other = ob_records_find(r, of, b, one->repeat, one->seed);
		double ratio = other && !other->failure ? one->metric[metric] / other->metric[metric] : NAN;
		if (isnan(ratio) || (logarithm && !(isfinite(ratio) && ratio > 0)))
			continue;
		x[n++] = logarithm ? log(ratio) : ratio;
	}
	return ob_statistics_summarise(n, x);
}

ob_estimate ob_records_estimate_ratio(const ob_records *r, const char *of, const char *a, const char *b, size_t metric)
{
	const ob_statistics s = ob_records_ratio(r, of, a, b, metric, true);
	return estimate(&s, true);
}

bool ob_records_have(const ob_records *r, const char *of, const char *configuration, const ob_record **failed)
{
	bool have = false;
	if (failed)
		*failed = NULL;
	for (size_t i = 0; i < r->count; i++) {
		if (!is_of(&r->record[i], of, configuration))
			continue;
		have = true;
		if (failed && r->record[i].failure && !*failed)
			*failed = &r->record[i];
	}
	return have;
}

// ---- cost at equal error. The lower envelope of the points in the plane of cost and error is the chain of points that
// no other beats in both: from point to point costlier and more accurate.

static int by_cost(const void *a, const void *b)
{
	const ob_cost_point *p = a, *q = b;
	if (p->cost != q->cost)
		return p->cost < q->cost ? -1 : 1;
	return (p->error > q->error) - (p->error < q->error);
}

// Cost at which the straight line in log-log between two points reaches the error. A point without error has no
// logarithm: the line is a step there.
static double between(ob_cost_point above, ob_cost_point below, double error)
{
	if (!(below.error > 0) || !(error > 0))
		return below.cost;
	double part = log(above.error / error) / log(above.error / below.error);
	return above.cost * pow(below.cost / above.cost, part);
}

double ob_cost_at_error(ob_cost_point *point, size_t count, double error)
{
	qsort(point, count, sizeof *point, by_cost);
	ob_cost_point last = { NAN, INFINITY }; // last point on the envelope
	for (size_t i = 0; i < count; i++) {
		if (point[i].error >= last.error)
			continue;
		if (point[i].error <= error)
			return isinf(last.error) ? point[i].cost : between(last, point[i], error);
		last = point[i];
	}
	return NAN;
}

// ---- statistics

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
