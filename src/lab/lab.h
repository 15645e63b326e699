// The lab as an experiment (experiment/experiment.h): hard cases, each with engines at settings. Pure but for what is
// run in trials; any thread.
#ifndef OB_LAB_LAB_H
#define OB_LAB_LAB_H

#include "experiment/experiment.h"
#include "lab/list.h"
#include "lab/result.h"
#include "lab/sweep.h"

// Metrics of a record; those of figures are in the case's units.
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

// commit: of the program; limit: s of CPU time for a trial
ob_experiment ob_lab_experiment(const char *commit, double limit);
// Case by case; within a case engines and settings take turns, repeat by repeat. false and e: no memory
bool ob_lab_schedule(const ob_lab_plan *p, ob_trials *to, ob_error *e);

// "obsim substeps=8 iterations=16": an engine and its settings as one text, and back. A zero is left out. false and e:
// not understood
void ob_lab_print_configuration(char *to, size_t room, const ob_engine_kind *k, const ob_run_settings *s);
bool ob_lab_read_configuration(const char *text, const ob_case *c, const ob_engine_kind **k, ob_run_settings *s,
			       ob_error *e);

// Records as results: medians of the times, and the worst of the figures. false and e: no memory, or they are not of
// this program's cases and engines. Finish to in either case.
bool ob_lab_results(const ob_records *from, ob_results *to, ob_error *e);

#endif
