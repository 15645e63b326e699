// The lab as an experiment (experiment/experiment.h): hard cases, each with engines at settings. Pure except for the
// work of trials; any thread.
#ifndef OB_LAB_LAB_H
#define OB_LAB_LAB_H

#include "experiment/experiment.h"
#include "lab/case.h"
#include "lab/analysis.h"

// ---- sweep

// Settings to run an engine at. Pure; any thread.

enum { OB_SWEEP_VALUES = 16, OB_SWEEP_SETTINGS = 288 }; // per setting; per engine and case

typedef struct ob_sweep {
	bool own; // a sensible default for each engine; the lists below are empty then
	struct {
		size_t n;
		double value[OB_SWEEP_VALUES];
	} of[OB_RUN_SETTINGS]; // substeps, iterations, tolerance (m) and lag
} ob_sweep;

// Parses "substeps=1,2,4,8,iterations=4,16,tolerance=5mm,.5mm,lag=0,1,2", each setting at most once; "none" = each
// engine's usual settings alone; NULL = a sensible default for each. Returns false and e if it is not valid.
bool ob_sweep_parse(ob_sweep *s, const char *text, ob_error *e);

// Lists the settings of an engine in a case without duplicates, the usual ones first: every number of substeps with
// every number of iterations, then the tolerances. Settings that an engine does not have keep their value. Returns
// their number; 0: the engine does not apply to this case.
size_t ob_sweep_settings(const ob_sweep *s, const ob_case *c, const ob_engine_kind *k,
			 ob_run_settings to[OB_SWEEP_SETTINGS]);

// ---- lab

// Metrics of a record; figures are in the case's units.
enum {
	OB_LAB_CPU,
	OB_LAB_WALL,
	OB_LAB_BODY_SECONDS,
	OB_LAB_CONSERVED,
	OB_LAB_FIGURE = OB_LAB_CONSERVED + OB_CONSERVED,
	OB_LAB_METRICS = OB_LAB_FIGURE + OB_FIGURES
};

typedef struct ob_lab_plan {
	ob_case_list cases;
	ob_engine_list engines;
	ob_sweep sweep;
	uint32_t repeats; // 1 .. OB_REPEATS
} ob_lab_plan;

// commit: of the program; limit: CPU time of a trial (s).
ob_experiment ob_lab_experiment(const char *commit, double limit);
// Schedules case by case; within a case engines and settings alternate, repeat by repeat. Returns false and e if memory
// runs out.
bool ob_lab_schedule(const ob_lab_plan *p, ob_trials *to, ob_error *e);

// Prints an engine and its settings as one text, "obsim substeps=8 iterations=16", without zeros; the other direction
// parses it. Returns false and e if it is not valid.
void ob_lab_print_configuration(char *to, size_t room, const ob_engine_kind *k, const ob_run_settings *s);
bool ob_lab_read_configuration(const char *text, const ob_case *c, const ob_engine_kind **k, ob_run_settings *s,
			       ob_error *e);

// Converts records to results: medians of the times, and the worst of the figures. Returns false and e if memory runs
// out, or if they do not belong to this program's cases and engines. Finish `to` in either case.
bool ob_lab_results(const ob_records *from, ob_results *to, ob_error *e);

#endif
