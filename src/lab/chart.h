// The report's diagrams, made of results. One thread at a time per chart.
#ifndef OB_LAB_CHART_H
#define OB_LAB_CHART_H

#include "experiment/chart.h"
#include "lab/analysis.h"

// NULL: there is nothing to show, or no memory. Each is to be given to ob_chart_free.
ob_chart *ob_lab_chart_cost(const ob_lab_analysis *d, const ob_case *c); // error over cost, a curve an engine
ob_chart *ob_lab_chart_convergence(const ob_lab_analysis *d,
				   const ob_case *c); // error over substeps, with the observed order
ob_chart *ob_lab_chart_promises(const ob_lab_analysis *d); // all cases: error over target, obsim beside other engines
ob_chart *ob_lab_chart_ghost(const ob_lab_analysis *d); // all cases: neighbours of infinite mass
ob_chart *ob_lab_chart_lag(const ob_lab_analysis *d); // error over how late partners are read

// What a setting is called at its point: "8", "240 Hz", "0.5 mm"
void ob_lab_chart_setting(const ob_result *r, char *to, size_t room);

#endif
