// Statistics over seeds, as single runs of chaotic motion prove nothing; lines through points; orders of convergence.
// Pure functions, thread-safe.
#ifndef OB_EXPERIMENT_STATISTICS_H
#define OB_EXPERIMENT_STATISTICS_H

#include <stddef.h>

typedef struct ob_statistics {
	size_t n;
	double mean, deviation; // deviation with n - 1
	double mean_low, mean_high; // 95 %, Student 1908; NAN for n < 2
	double median, least, most;
	double median_low, median_high; // at least 95 %, from the order statistics (Thompson 1936); NAN for n < 6
} ob_statistics;

// Sorts x. n = 0 gives NAN everywhere. NaN in x turns every result that depends on it into NaN.
ob_statistics ob_statistics_summarise(size_t n, double *x);

// Quantile t of Student's distribution with so many degrees of freedom: |T| <= t with probability p (Abramowitz and
// Stegun 1964, 26.7.3 and 26.7.4); 0 < p < 1.
double ob_statistics_student(int freedom, double p);

typedef struct ob_line {
	size_t n;
	double slope, intercept;
	double slope_low, slope_high; // 95 %, Student's t with n - 2 degrees of freedom; NAN for n < 3
	double squares; // residual: sum of the squared distances in y
	double mean_y;
} ob_line;

// Least-squares line; NAN everywhere for n < 2, or if all x are equal. (Gauss 1809; the interval as in Draper and Smith
// 1966.)
ob_line ob_statistics_line(size_t n, const double *x, const double *y);

// Convergence order of errors against a known reference: the slope of log error over log h, by least squares over the
// points with error > floor (below it, rounding dominates). NAN with fewer than two such points.
double ob_statistics_order(size_t n, const double *h, const double *error, double floor);

#endif
