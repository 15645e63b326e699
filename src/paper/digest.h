// What samples say together: means, ratios of pairs of runs, growth with the number of objects; with confidence
// intervals of 95 %. Pure functions.
#ifndef OB_PAPER_DIGEST_H
#define OB_PAPER_DIGEST_H

#include "paper/sample.h"
#include "reference/statistics.h"

typedef enum ob_paper_quantity {
	OB_PAPER_STEP,
	OB_PAPER_TOTAL,
	OB_PAPER_ONE,
	OB_PAPER_BUSIEST,
	OB_PAPER_CPU,
	OB_PAPER_DEMAND,
	OB_PAPER_PACE,
	OB_PAPER_FPS,
	OB_PAPER_VIEWER,
	OB_PAPER_TESTS,
	OB_PAPER_MEMORY,
	OB_PAPER_QUANTITIES
} ob_paper_quantity;

typedef struct ob_paper_quantity_def {
	const char *key, *title, *unit; // in files, in SI; for people, in the unit
	double scale; // to that unit
	size_t offset; // of a double in ob_paper_sample
} ob_paper_quantity_def;

extern const ob_paper_quantity_def ob_paper_quantities[OB_PAPER_QUANTITIES];

double ob_paper_value(const ob_paper_sample *s, ob_paper_quantity q);
// NULL: it is not there, or failed.
const ob_paper_sample *ob_paper_find(const ob_paper_results *r, ob_paper_scenario s, uint32_t experiment);

enum { OB_PAPER_EXPERIMENTS_MAX = 64 };

// Over the experiments that did not fail and measured it
ob_statistics ob_paper_summarise(const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q);

typedef struct ob_paper_ratio {
	size_t n; // pairs
	double mean, low, high; // NaN: unknown
} ob_paper_ratio;

// a over b, pairs of the same experiment: geometric mean, interval by Student on the logarithms
ob_paper_ratio ob_paper_compare(const ob_paper_results *r, ob_paper_scenario a, ob_paper_scenario b,
				ob_paper_quantity q);

typedef struct ob_paper_growth {
	ob_line linear, logarithmic; // value over n, value over ln n
	ob_line power; // ln value over ln n: the slope is the exponent
	double favour; // how much likelier the line is than the logarithm, as a natural logarithm (Akaike 1974)
} ob_paper_growth;

ob_paper_growth ob_paper_grow(const ob_paper_results *r, ob_paper_scenario s, ob_paper_quantity q);
// What the data prefer, by odds of ten to one: 1 the line, -1 the logarithm, 0 neither (or too few runs)
int ob_paper_prefers(const ob_paper_growth *g);

#endif
