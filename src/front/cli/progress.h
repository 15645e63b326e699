// Progress line of a long run on a terminal. Its own thread reads the universe, so that nothing has to pause for it.
#ifndef OB_CLI_PROGRESS_H
#define OB_CLI_PROGRESS_H

#include <stddef.h>

#include <ob/universe.h>

typedef struct ob_progress ob_progress;

// NULL if standard error is no terminal. Nothing is shown in the first two seconds.
// u must live until ob_progress_end. steps: number of the whole run.
ob_progress *ob_progress_begin(const ob_universe *u, uint64_t steps);
void ob_progress_end(ob_progress *p); // removes the line; NULL is allowed

#endif
