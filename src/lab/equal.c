// Cost at equal error, read off the results. The lower envelope of an engine's points in the plane of cost and error is
// the chain of those that no other point beats in both: from point to point costlier and more exact.
#include <stdlib.h>

#include "lab/result.h"

typedef struct point {
	double cost, error;
} point;

static int by_cost(const void *a, const void *b)
{
	const point *p = a, *q = b;
	if (p->cost != q->cost)
		return p->cost < q->cost ? -1 : 1;
	return (p->error > q->error) - (p->error < q->error);
}

// Points of runs that did not fail; returns how many.
static size_t gather(const ob_results *r, const ob_case *c, const ob_engine_kind *k, point *to)
{
	size_t count = 0;
	for (size_t i = 0; i < r->count; i++) {
		const ob_result *one = &r->result[i];
		point p = { ob_result_cost(one), one->outcome.figure[0] };
		if (one->of == c && one->engine == k && !*one->outcome.failed && isfinite(p.error) && p.cost > 0 &&
		    isfinite(p.cost))
			to[count++] = p;
	}
	return count;
}

// Where the straight line between two points in log-log comes down to the error. A point without any error has no
// logarithm: there the line is a step.
static double between(point above, point below, double error)
{
	if (!(below.error > 0) || !(error > 0))
		return below.cost;
	double part = log(above.error / error) / log(above.error / below.error);
	return above.cost * pow(below.cost / above.cost, part);
}

double ob_cost_at(const ob_results *r, const ob_case *c, const ob_engine_kind *k, double error)
{
	point *list = calloc(r->count + 1, sizeof *list);
	if (!list)
		return NAN;
	size_t count = gather(r, c, k, list);
	qsort(list, count, sizeof *list, by_cost);
	point last = { NAN, INFINITY }; // on the envelope
	double cost = NAN;
	for (size_t i = 0; i < count && isnan(cost); i++) {
		if (list[i].error >= last.error)
			continue;
		if (list[i].error <= error)
			cost = isinf(last.error) ? list[i].cost : between(last, list[i], error);
		last = list[i];
	}
	free(list);
	return cost;
}
