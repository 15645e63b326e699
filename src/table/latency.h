// How long steps took: a histogram of fixed size with bins 2 % wide, so that a run of any length costs 8 kB and a
// percentile is right to 1 %. One thread at a time.
#ifndef OB_TABLE_LATENCY_H
#define OB_TABLE_LATENCY_H

#include <stdint.h>

enum { OB_LATENCY_BINS = 1100 }; // .1 us .. 290 s

typedef struct ob_latency {
	uint64_t count[OB_LATENCY_BINS], total;
} ob_latency;

// n steps of the given wall time (s) each
void ob_latency_add(ob_latency *l, double seconds, uint64_t n);
// The time (s) that the given fraction of the steps did not exceed; 0 when there were none.
double ob_latency_percentile(const ob_latency *l, double fraction);

#endif
