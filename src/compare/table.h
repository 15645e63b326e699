// A sweep point as a table: metrics downwards, configurations across.
#ifndef OB_COMPARE_TABLE_H
#define OB_COMPARE_TABLE_H

#include "compare/compare.h"
#include "experiment/table.h"

// intervals: in each cell; otherwise only those of the cost, in a row of their own. NULL: no runs.
ob_table *ob_comparison_table(const ob_comparison *c, const ob_sweep_point *p, bool intervals);
// Cost of each measure of --harden: CPU and wall time over the same run without it. NULL: none was priced.
ob_table *ob_comparison_prices(const ob_comparison *c, const ob_sweep_point *p);
// Prints "6 runs of each", "3 runs of each of 4 seeds".
void ob_comparison_print_runs(const ob_comparison *c, char *to, size_t room);

#endif
