// The children of a comparison. One thread.
#ifndef OB_CLI_COMPARE_RUN_H
#define OB_CLI_COMPARE_RUN_H

#include "cli/compare.h"

typedef struct ob_crew_run {
	const ob_arguments *arguments;
	ob_comparison *comparison;
	int runs, runs_planned;
} ob_crew_run;

// One more sample of a way; false: it failed, and the cell says why.
bool ob_crew_run_sample(ob_crew_run *p, ob_section *s, ob_way_id way);
// Measures each step of a run of the first of these ways that was run, and gives its figures to all that end in the same
// bits.
void ob_crew_run_measured(ob_crew_run *p, ob_section *s, ob_way_id first, ob_way_id last);
// A run with frames: what drawing costs, and how many are drawn in a second.
void ob_crew_run_drawn(ob_crew_run *p, ob_section *s, ob_way_id way);

#endif
