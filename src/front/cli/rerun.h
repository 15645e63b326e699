// Logs of requests (host/request_log.h): their heads, states, and the run that carries them out again.
#ifndef OB_CLI_RERUN_H
#define OB_CLI_RERUN_H

#include "cli/request.h"

// Returns the head of a log of this run. spare: slots for objects added on request.
ob_request_log_head ob_rerun_head(const ob_run_request *r, const ob_scene *s, uint32_t spare);
// Logs the state if step *next has come, and advances *next. The universe stands still at a step boundary. log NULL:
// does nothing.
void ob_rerun_log_state(ob_request_log *log, const ob_host *h, uint64_t *next);

#endif
