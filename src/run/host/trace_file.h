// A trace as JSON in the Trace Event Format, which ui.perfetto.dev and chrome://tracing open.
//
// Importers have rules: spans of one track nest or stand apart, and of two that begin together the outer one comes
// first. They read times as doubles in microseconds, and convert them to whole nanoseconds, each in its own way. So all
// times are rounded down to eighths of a microsecond, which every conversion keeps.
//
// The file is whole at any time: each write ends with the end of the JSON, which the next write overwrites with its
// events. So a host may be killed. Only a signal between two pages of one write could tear the file. So a write is
// about as large as a page, and writes are few. A pipe gets the end once.
//
// Not thread-safe. Write errors are reported by close.
#ifndef OB_HOST_TRACE_FILE_H
#define OB_HOST_TRACE_FILE_H

#include "table/trace.h"

typedef struct ob_trace_file ob_trace_file;

// Opens the file, and names its tracks after the universe's workers. NULL and e on failure.
ob_trace_file *ob_trace_file_open(const char *path, const ob_universe *u, ob_error *e);
// Adds an event of a ring, of any kind. unfinished: it has not ended.
void ob_trace_file_put(ob_trace_file *f, uint32_t ring, const ob_trace_event *event, bool unfinished);
// Names object id's track after its passport. Call it again when the slot has another object.
void ob_trace_file_name_object(ob_trace_file *f, uint32_t id);
// Adds an instant to the ring's track: the death of its simulator at this time (ns), in this step.
void ob_trace_file_put_death(ob_trace_file *f, uint32_t ring, const char *what, uint64_t step, uint64_t when);
// Adds an instant to the ring's track: that number of events is missing before this time (ns).
void ob_trace_file_put_lost(ob_trace_file *f, uint32_t ring, uint64_t lost, uint64_t when);
// Writes out all events so far.
void ob_trace_file_flush(ob_trace_file *f);
// Ends the file and frees f. false and e if any write failed.
bool ob_trace_file_close(ob_trace_file *f, uint64_t events, uint64_t lost, ob_error *e);

#endif
