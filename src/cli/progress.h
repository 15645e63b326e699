// The line on a terminal that says how far a long run has come. Its own thread looks into the universe, so that
// nothing else has to pause for it.
#ifndef OB_CLI_PROGRESS_H
#define OB_CLI_PROGRESS_H

#include <stddef.h>

#include <ob/universe.h>

typedef struct ob_progress ob_progress;

// NULL where standard error is no terminal, and nothing is shown in the first two seconds.
// u must live until the end is called. steps: of the whole run.
ob_progress *ob_progress_begin(const ob_universe *u, uint64_t steps);
void ob_progress_end(ob_progress *p); // takes the line away; NULL is allowed

#endif
