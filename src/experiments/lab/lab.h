// The lab as an experiment (experiment/experiment.h): hard cases, each with engines at settings. Pure except for the
// work of trials; any thread.
#ifndef OB_LAB_LAB_H
#define OB_LAB_LAB_H

#include "experiment/experiment.h"
#include "lab/case.h"
#include "lab/result.h"
#include "lab/sweep.h"

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
