// Statistics over seeds, where motion is chaotic and a single run proves nothing. Pure functions, thread-safe.
#ifndef OB_REFERENCE_STATISTICS_H
#define OB_REFERENCE_STATISTICS_H

#include <stddef.h>

typedef struct ob_statistics {
	size_t n;
	double mean, deviation; // deviation with n - 1
	double mean_low, mean_high; // 95 %, Student 1908; NAN for n < 2
	double median, least, most;
	double median_low, median_high; // at least 95 %, from the order statistics (Thompson 1936); NAN for n < 6
} ob_statistics;

// x is sorted on the way. n = 0 gives NAN everywhere. NaN in x spoils all that it would enter: it stays NaN.
ob_statistics ob_reference_summarise(size_t n, double *x);

// The t that Student's distribution with so many degrees of freedom stays within, on both sides, with probability p
// (Abramowitz and Stegun 1964, 26.7.3 and 26.7.4); 0 < p < 1.
double ob_reference_student(int freedom, double p);

#endif
