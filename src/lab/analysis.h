// What a report asks of results: who took part, what holds at usual settings, who is cheaper at equal error. Pure but
// for ob_lab_analyse; any thread.
#ifndef OB_LAB_ANALYSIS_H
#define OB_LAB_ANALYSIS_H

#include "lab/result.h"

enum { OB_LAB_ANALYSIS_ENGINES = 24, OB_LAB_ANALYSIS_ROWS = 64 };

typedef struct ob_lab_analysis {
	const ob_results *results;
	size_t engines;
	const ob_engine_kind *engine[OB_LAB_ANALYSIS_ENGINES]; // in the order of the results
	const ob_engine_kind *own; // obsim itself; NULL: it did not take part
} ob_lab_analysis;

ob_lab_analysis ob_lab_analyse(const ob_results *r);

bool ob_lab_analysis_is_obsim(const ob_engine_kind *k); // or one of its variants, as opposed to other engines
size_t ob_lab_analysis_count_others(const ob_lab_analysis *d); // engines that took part and are not obsim
int ob_lab_analysis_style(const ob_lab_analysis *d, const ob_engine_kind *k); // of its curves, the same in every report

// At an engine's usual settings; NULL: was not run
const ob_result *ob_lab_analysis_usual(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k);
// The result that a case's targets are promised for; NULL: was not run
const ob_result *ob_lab_analysis_promised(const ob_lab_analysis *d, const ob_case *c);
bool ob_lab_analysis_ran(const ob_lab_analysis *d, const ob_case *c); // with any engine

bool ob_lab_analysis_has_target(const ob_case *c, uint32_t figure);
bool ob_lab_analysis_meets(const ob_result *r, uint32_t figure); // false, too, where the run failed
bool ob_lab_analysis_meets_all(const ob_result *r);
// Within its bound, or not kept by the case's worlds. false, too, where the run broke down.
bool ob_lab_analysis_conserves(const ob_result *r, ob_conserved what);
// Worst of figure over target, of those with a target: <= 1 where all are met. Infinite where it failed, or where all
// that is missed is a target of 0; NAN without targets.
double ob_lab_analysis_ratio(const ob_result *r);

// The other engine that has the smallest figure at its usual settings, failed runs left out; NULL: none
const ob_result *ob_lab_analysis_best_other(const ob_lab_analysis *d, const ob_case *c, uint32_t figure);

typedef struct ob_lab_analysis_rows {
	int measured, met; // rows of the table of hard cases
} ob_lab_analysis_rows;
ob_lab_analysis_rows ob_lab_analysis_count_rows(const ob_lab_analysis *d);

// Cost at equal error of one case: at its target, or where no engine gets there, at the least error of obsim's.
typedef struct ob_lab_analysis_equal {
	double error; // in the unit of figure 0; NAN: there is none
	bool is_target;
	double cost[OB_LAB_ANALYSIS_ENGINES]; // s of CPU per body and simulated second, by engine; NAN = never
	double own; // obsim's
	bool ahead; // obsim gets there, and none of the others at less cost
} ob_lab_analysis_equal;
ob_lab_analysis_equal ob_lab_analysis_compare(const ob_lab_analysis *d, const ob_case *c);
// The result with which an engine has its least error in a case; NULL: all failed
const ob_result *ob_lab_analysis_finest(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k);

#endif
