// Diagrams of the report, from results. One thread at a time per chart.
#ifndef OB_LAB_CHART_H
#define OB_LAB_CHART_H

#include "experiment/chart.h"
#include "lab/analysis.h"

// NULL: nothing to show, or out of memory. Pass each to ob_chart_free.
ob_chart *ob_lab_chart_cost(const ob_lab_analysis *d, const ob_case *c); // error over cost, a curve an engine
ob_chart *ob_lab_chart_convergence(const ob_lab_analysis *d,
				   const ob_case *c); // error over substeps, with the observed order
ob_chart *ob_lab_chart_promises(const ob_lab_analysis *d); // all cases: error over target, obsim beside other engines
ob_chart *ob_lab_chart_ghost(const ob_lab_analysis *d); // all cases: neighbours of infinite mass
// Error of free simulators over the delay of what they publish, with its order. NULL: none was run.
ob_chart *ob_lab_chart_delay(const ob_lab_analysis *d, const ob_case *c);
ob_chart *ob_lab_chart_lag(const ob_lab_analysis *d); // error over the delay of reading partners

// Prints a setting as the label of its point: "8", "240 Hz", "0.5 mm".
void ob_lab_chart_setting(const ob_result *r, char *to, size_t room);

#endif
