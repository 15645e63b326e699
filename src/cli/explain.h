// What a run modelled, what it left out and why, and what each part of its steps cost.
#ifndef OB_CLI_EXPLAIN_H
#define OB_CLI_EXPLAIN_H

#include <stdio.h>

#include "cli/request.h"
#include "table/table.h"

typedef struct ob_explained {
	const ob_run_request *request; // settled
	const ob_scene *scene;
	const ob_run_settings *settings;
	ob_counters counters; // of all workers
	double body_steps; // steps times bodies
	double cpu_s; // of all workers
} ob_explained;

void ob_explain_print(const ob_explained *x, FILE *f);

#endif
