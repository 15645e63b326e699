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
