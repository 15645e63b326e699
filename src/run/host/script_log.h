// Errors of scripts in a run: logged once, across restarts, and kept for its report.
//
// Thread-safety: the host's thread only, while the universe is paused.
#ifndef OB_HOST_SCRIPT_LOG_H
#define OB_HOST_SCRIPT_LOG_H

#include "host/request.h"
#include "table/table.h"

// Error that has stopped the script of an object.
typedef struct ob_script_error {
	uint64_t step; // step before which the script ran, from 1
	uint32_t object, generation;
	char name[OB_NAME_MAX]; // of the object
	char text[OB_SCRIPT_ERROR_BYTES + 1]; // with the line of the script, as "bird.lua:7: ..."; UTF-8
} ob_script_error;

typedef struct ob_script_log {
	uint32_t failed; // ob_script_counts.failed at the last look
	uint64_t warned; // bit i: script i was warned of
	uint64_t *last; // [cells]: object of the last error in a cell: generation << 32 | id
	uint32_t cells;
	ob_script_error *error; // [errors]
	size_t errors, errors_max;
} ob_script_log;

// Logs errors, and warnings of what has no effect, that came since the last look. Without memory some are logged again.
void ob_script_log_look(ob_script_log *l, const ob_universe *u);
// Writes the first errors of the run, by step and object, "most" of them at most; returns their number.
uint32_t ob_script_log_first(ob_script_log *l, ob_script_error *out, uint32_t most);
void ob_script_log_finish(ob_script_log *l);

// ---- script request

// Requests of scripts to the host, as they lie in a universe, which is not trusted. Thread-safety: the host's thread, at a pause.

// Makes a request from a script's post to steer its object. false: it makes no sense.
bool ob_script_request_read(const ob_script_post *post, ob_request *r);
// Stops the script of a cell after an invalid request at this line, with an error that explains it.
void ob_script_request_refuse(ob_universe *u, uint32_t cell, uint32_t line, const char *why);

#endif
