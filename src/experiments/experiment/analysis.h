// Analysis of records: values, medians with intervals, ratios sample by sample, cost at equal error. (Orders of
// convergence, lines of least squares: reference/.) Pure functions; any thread.
#ifndef OB_EXPERIMENT_ANALYSIS_H
#define OB_EXPERIMENT_ANALYSIS_H

#include <stddef.h>

#include "experiment/experiment.h"

// ---- statistics

// Statistics over seeds, as single runs of chaotic motion prove nothing; lines through points; orders of convergence.
// Pure functions, thread-safe.

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

// ---- analysis

enum { OB_SAMPLES = 128 }; // samples used of one case and configuration

// Median, mean, and their 95 % intervals, of a metric over the completed trials that measured it without failure;
// OB_SAMPLES at most.
ob_statistics ob_records_summarise(const ob_records *r, const char *of, const char *configuration, size_t metric);

typedef struct ob_estimate {
	size_t n; // samples
	double value, low, high; // NAN: unknown
	bool interval; // low and high bound it with 95 %; else they are the least and the most
} ob_estimate;

// Median; the least and the most where so few samples (2 to 5) give no interval.
ob_estimate ob_estimate_median(const ob_statistics *s);

// Means with Student's interval, from 3 samples on. Geometric mean, by the logarithms, if all values are positive and it is asked for; else the arithmetic one. Samples as
// above.
ob_estimate ob_records_estimate(const ob_records *r, const char *of, const char *configuration, size_t metric,
				bool geometric);
// Geometric mean of the ratios of configurations a and b in the same case, seed by seed.
ob_estimate ob_records_estimate_ratio(const ob_records *r, const char *of, const char *a, const char *b, size_t metric);
// Ratio of configurations a and b in the same case, repeat by repeat and seed by seed: variation between samples
// cancels out. logarithm: uses the natural logarithms of the ratios, for a geometric mean.
ob_statistics ob_records_ratio(const ob_records *r, const char *of, const char *a, const char *b, size_t metric,
			       bool logarithm);

// True if the configuration has run in this case. failed: one of its failed trials; NULL = not wanted.
bool ob_records_have(const ob_records *r, const char *of, const char *configuration, const ob_record **failed);

typedef struct ob_cost_point {
	double cost, error;
} ob_cost_point;

// Cheapest cost at an error at or below "error": read off the lower envelope of the points of successful runs (sorts
// them), with straight lines in log-log between them. NAN: never reached
double ob_cost_at_error(ob_cost_point *point, size_t count, double error);

#endif
