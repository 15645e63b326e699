// What records say together: values, medians with intervals, ratios sample by sample, cost at equal error. (Orders of
// convergence, lines of least squares: reference/.) Pure functions; any thread.
#ifndef OB_EXPERIMENT_ANALYSIS_H
#define OB_EXPERIMENT_ANALYSIS_H

#include "experiment/experiment.h"
#include "reference/statistics.h"

enum { OB_SAMPLES = 128 }; // of one case and configuration, that are looked at

// Median, mean, and their intervals of 95 %, of a metric in the trials that came to their end without a failure, and
// measured it; of OB_SAMPLES at most
ob_statistics ob_records_summarise(const ob_records *r, const char *of, const char *configuration, size_t metric);
// Of configuration a over b in the same case, repeat by repeat and seed by seed: what changes from one to the next
// cancels out. logarithm: of the natural logarithms of the ratios, for a geometric mean.
ob_statistics ob_records_ratio(const ob_records *r, const char *of, const char *a, const char *b, size_t metric,
			       bool logarithm);

// Has the configuration run in this case? failed: has one of its trials failed; NULL = not asked
bool ob_records_have(const ob_records *r, const char *of, const char *configuration, const ob_record **failed);

typedef struct ob_cost_point {
	double cost, error;
} ob_cost_point;

// The cheapest cost at which the error is at or below "error": read off the lower envelope of the points (of runs that
// did not fail; they are sorted on the way), between them by straight lines in log-log. NAN: never
double ob_cost_at_error(ob_cost_point *point, size_t count, double error);

#endif
