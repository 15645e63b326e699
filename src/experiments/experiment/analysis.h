// Analysis of records: values, medians with intervals, ratios sample by sample, cost at equal error. (Orders of
// convergence, lines of least squares: reference/.) Pure functions; any thread.
#ifndef OB_EXPERIMENT_ANALYSIS_H
#define OB_EXPERIMENT_ANALYSIS_H

#include "experiment/experiment.h"
#include "experiment/statistics.h"

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
