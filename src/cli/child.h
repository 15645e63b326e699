// Runs obsim itself as a child with other arguments, and collects what it says. One at a time.
#ifndef OB_CLI_CHILD_H
#define OB_CLI_CHILD_H

#include <stdbool.h>

#include <ob/error.h>

typedef struct ob_child_result {
	int code; // exit status; 128 + number if a signal ended it
	char *out; // its standard output, with a final 0; never NULL after success
	char *complaint; // the last line that it wrote to standard error as "obsim: ..."; "" = none
} ob_child_result;

// argv[0] is replaced by this program. While the child runs, SIGINT and SIGTERM are passed on to it, and it does not
// outlive its parent. false and e if it could not be started or read.
bool ob_child_run(char *const argv[], ob_child_result *r, ob_error *e);
void ob_child_finish(ob_child_result *r);
// SIGINT or SIGTERM came during a run.
bool ob_child_interrupted(void);

#endif
