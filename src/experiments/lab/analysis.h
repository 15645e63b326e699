// Analysis of results for reports: participating engines, figures at usual settings, cheapest engine at equal error.
// Pure except for ob_lab_analyse; any thread.
#ifndef OB_LAB_ANALYSIS_H
#define OB_LAB_ANALYSIS_H

#include "experiment/table.h"
#include "lab/case.h"

// ---- result

// Results of the lab: one per case, engine and setting.

enum { OB_REPEATS = 15 }; // at most

typedef struct ob_result {
	const ob_case *of;
	const ob_engine_kind *engine;
	ob_run_settings settings;
	ob_case_result outcome; // medians of the repeats' times, and the worst of their figures
	uint32_t repeats;
	double cpu_s[OB_REPEATS], wall_s[OB_REPEATS]; // of each repeat
} ob_result;

typedef struct ob_results {
	size_t count, max;
	ob_result *result; // in the order of cases, engines, settings
	char machine[192]; // processor, cores, kernel
	char commit[64];
} ob_results;

// CPU seconds per body and simulated second.
static inline double ob_result_cost(const ob_result *r)
{
	return r->outcome.cpu_s / r->outcome.body_seconds;
}

// Orders by case, engine and setting, from coarse to fine; < 0, 0 or > 0
int ob_result_order(const ob_result *a, const ob_result *b);
ob_result *ob_results_find(const ob_results *r, const ob_case *c, const ob_engine_kind *k, const ob_run_settings *s);
bool ob_results_add(ob_results *r, const ob_result *one); // in order; false: out of memory
// Adds one more repeat: updates medians and worst figures. No effect if there are OB_REPEATS already.
void ob_result_repeat(ob_result *r, const ob_case_result *again);
void ob_results_finish(ob_results *r);

// Cheapest cost (s of CPU per body and simulated second) at which an engine keeps figure 0 of a case at or below
// "error" (ob_cost_at_error). NAN: never.
double ob_cost_at(const ob_results *r, const ob_case *c, const ob_engine_kind *k, double error);

// ---- analysis

enum { OB_LAB_ANALYSIS_ENGINES = 24, OB_LAB_ANALYSIS_ROWS = 64 };

typedef struct ob_lab_analysis {
	const ob_results *results;
	size_t engines;
	const ob_engine_kind *engine[OB_LAB_ANALYSIS_ENGINES]; // in the order of the results
	const ob_engine_kind *own; // obsim itself; NULL: not in the results
} ob_lab_analysis;

ob_lab_analysis ob_lab_analyse(const ob_results *r);

bool ob_lab_analysis_is_obsim(const ob_engine_kind *k); // true for obsim and its variants, false for other engines
size_t ob_lab_analysis_count_others(const ob_lab_analysis *d); // engines in the results other than obsim
int ob_lab_analysis_style(const ob_lab_analysis *d,
			  const ob_engine_kind *k); // style of its curves, the same in every report

// Next result after one (NULL: the first) of a case and an engine; NULL for either: of any. NULL: none
const ob_result *ob_lab_analysis_next(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k,
				      const ob_result *after);

// Result at an engine's usual settings; NULL: not run.
const ob_result *ob_lab_analysis_usual(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k);
// Result for which a case's targets are promised; NULL: not run.
const ob_result *ob_lab_analysis_promised(const ob_lab_analysis *d, const ob_case *c);

bool ob_lab_analysis_has_target(const ob_case *c, uint32_t figure);
bool ob_lab_analysis_meets(const ob_result *r, uint32_t figure); // also false if the run failed
bool ob_lab_analysis_meets_all(const ob_result *r);
// True if within its bound, or not conserved in the case's worlds. Also false if the run broke down.
bool ob_lab_analysis_conserves(const ob_result *r, ob_conserved what);
// Worst ratio of a figure to its target, over figures with a target: <= 1 if all are met. Infinite if the run failed,
// or if all missed targets are 0; NAN without targets.
double ob_lab_analysis_ratio(const ob_result *r);

// Other engine with the smallest figure at its usual settings, without failed runs; NULL: none
const ob_result *ob_lab_analysis_best_other(const ob_lab_analysis *d, const ob_case *c, uint32_t figure);

typedef struct ob_lab_analysis_rows {
	int measured, met; // rows of the table of hard cases
} ob_lab_analysis_rows;
ob_lab_analysis_rows ob_lab_analysis_count_rows(const ob_lab_analysis *d);

// Cost at equal error of one case: at its target, or, if no engine reaches it, at obsim's least error.
typedef struct ob_lab_analysis_equal {
	double error; // in the unit of figure 0; NAN: there is none
	bool is_target;
	double cost[OB_LAB_ANALYSIS_ENGINES]; // s of CPU per body and simulated second, by engine; NAN = never
	double own; // obsim's
	bool ahead; // obsim reaches it, and no other engine does at less cost
} ob_lab_analysis_equal;
ob_lab_analysis_equal ob_lab_analysis_compare(const ob_lab_analysis *d, const ob_case *c);
// All compared cases at equal error.
typedef struct ob_lab_analysis_lead {
	int compared, ahead,
		within; // cases; those with obsim ahead; other ones where it is within twice the cost of the best
	bool never; // there are errors that obsim does not reach
	double worst; // its largest cost over that of another engine, where it is not ahead; 0: none
} ob_lab_analysis_lead;
ob_lab_analysis_lead ob_lab_analysis_measure_lead(const ob_lab_analysis *d);
// Result of an engine with its least error in a case; NULL: all failed
const ob_result *ob_lab_analysis_finest(const ob_lab_analysis *d, const ob_case *c, const ob_engine_kind *k);

// ---- audit

// Convergence audit: obsim's errors in each case as its tolerance shrinks and as its substeps grow. A finer setting
// must give a smaller error: any error above its target that is larger at the finer setting is reported. Below the
// target an error need not fall. If it more than doubles there, and exceeds rounding (a thousandth of the target), it
// is reported separately. Pure; any thread.

#define OB_AUDIT_SWEEP "substeps=4,8,16,32,64,128,256,tolerance=10mm,1mm,.1mm,.01mm"
enum { OB_AUDIT_TOLERANCES = 4, OB_AUDIT_SUBSTEPS = 7, OB_AUDIT_SETTINGS = OB_AUDIT_TOLERANCES + OB_AUDIT_SUBSTEPS };

// Figure that is larger at a finer setting; figure < 0: none
typedef struct ob_audit_rise {
	int figure, setting; // the figure; the finer setting
	double times; // ratio to the coarser one; INFINITY: it failed, or the coarser was 0
} ob_audit_rise;

typedef struct ob_audit {
	int measured; // settings
	const ob_result *result[OB_AUDIT_SETTINGS]; // tolerances from coarse to fine, then substeps; NULL: no result
	double ratio[OB_AUDIT_SETTINGS]; // worst figure over its target; INFINITY: failed; NAN: no result
	// Order at which the ratio falls with the length of a substep, above rounding. NAN: it is below 1 and does not
	// change, or has less than two values above rounding.
	double order;
	ob_audit_rise above, below; // the worst rise above a target, and below it
} ob_audit;

ob_audit ob_lab_audit(const ob_lab_analysis *d, const ob_case *c);

// NULL: no case was audited.
ob_table *ob_lab_table_audit(const ob_lab_analysis *d);
// Prints the table and the list of rises, for a terminal or as Markdown; nothing if no case was audited.
void ob_lab_print_audit(FILE *f, const ob_lab_analysis *d, bool markdown);

#endif
