#include "table/latency.h"

#include <math.h>

static const double shortest = 1e-7, width = 1.02; // s, ratio

void ob_latency_add(ob_latency *l, double seconds, uint64_t n)
{
	double bin = seconds > shortest ? floor(log(seconds / shortest) / log(width)) : 0;
	l->count[(int)fmin(bin, OB_LATENCY_BINS - 1)] += n;
	l->total += n;
}

double ob_latency_percentile(const ob_latency *l, double fraction)
{
	uint64_t rank = (uint64_t)ceil(fraction * (double)l->total), seen = 0;
	for (int i = 0; i < OB_LATENCY_BINS; i++) {
		seen += l->count[i];
		if (seen > 0 && seen >= rank)
			return shortest * pow(width, i + .5);
	}
	return 0;
}
