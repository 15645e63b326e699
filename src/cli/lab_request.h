// What the command line asks of the lab.
#ifndef OB_CLI_LAB_REQUEST_H
#define OB_CLI_LAB_REQUEST_H

#include "cli/options.h"
#include "lab/lab.h"

typedef struct ob_lab_request {
	ob_lab_plan plan; // without file and tick
	const char *out; // folder
	bool list, fresh, json, check;
} ob_lab_request;

// false and e on what is not understood or contradictory. The strings stay those of a.
bool ob_lab_request_read(ob_lab_request *r, const ob_arguments *a, ob_error *e);

#endif
