// Awkward diagrams: one point, no range, no data, NaN, the largest numbers, the longest titles.
#ifndef OB_TESTS_AWKWARD_H
#define OB_TESTS_AWKWARD_H

#include "plot/plot.h"

enum { AWKWARD_SERIES = 12, AWKWARD_POINTS = 40, AWKWARD_CATEGORIES = 60 };

typedef struct awkward {
	const char *name;
	ob_plot plot;
	ob_plot_series series[AWKWARD_SERIES];
	ob_plot_point point[AWKWARD_SERIES][AWKWARD_POINTS];
	ob_plot_mark mark[3];
	const char *category[AWKWARD_CATEGORIES];
} awkward;

// Fills in the i-th; returns false beyond the last. The contents are valid until it is filled again.
bool awkward_make(awkward *a, int i);

#endif
