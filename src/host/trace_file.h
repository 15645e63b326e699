// A trace as JSON in the Trace Event Format, which ui.perfetto.dev and chrome://tracing open.
//
// Importers have rules: spans of one track nest or stand apart, and of two that begin together the outer one must come
// first. Times are microseconds, which they read as doubles and turn into whole nanoseconds, each in its own way; so all
// are rounded down to eighths of a microsecond, which come through every way as they are.
//
// The file is whole at any time: with the events each write brings the end of the JSON, which the next write puts its
// events over. So a host may be killed. Only a signal that comes while the kernel goes from one page of a write to the
// next could tear it, so a write is about as large as a page, and there are few. A pipe gets the end once.
//
// Not thread-safe. What cannot be written is noticed in the end.
#ifndef OB_HOST_TRACE_FILE_H
#define OB_HOST_TRACE_FILE_H

#include "table/trace.h"

typedef struct ob_trace_file ob_trace_file;

// Names tracks as the universe has workers. NULL and e on failure.
ob_trace_file *ob_trace_file_open(const char *path, const ob_universe *u, ob_error *e);
// An event of a ring, whatever its kind. unfinished: it had not ended.
void ob_trace_file_put(ob_trace_file *f, uint32_t ring, const ob_trace_event *event, bool unfinished);
// The name of object id's track, as its passport has it now; again when the object is another.
void ob_trace_file_name_object(ob_trace_file *f, uint32_t id);
// On the ring's track: what is known of the death of its simulator at this instant (ns), in this step.
void ob_trace_file_put_death(ob_trace_file *f, uint32_t ring, const char *what, uint64_t step, uint64_t when);
// On the ring's track: so many events are missing before this instant (ns).
void ob_trace_file_put_lost(ob_trace_file *f, uint32_t ring, uint64_t lost, uint64_t when);
// Writes down what has been put so far.
void ob_trace_file_flush(ob_trace_file *f);
// Ends the file and frees f. false and e if anything could not be written.
bool ob_trace_file_close(ob_trace_file *f, uint64_t events, uint64_t lost, ob_error *e);

#endif
