// The timeline: a thread that takes the spans out of the universe's rings (table/trace.h) about twenty times a second
// and writes them to a file during the run.
//
// Thread-safety: start and finish are one thread's.
#ifndef OB_HOST_TIMELINE_H
#define OB_HOST_TIMELINE_H

#include "host/worker.h"
#include "table/trace.h"

typedef struct ob_timeline ob_timeline;

typedef struct ob_timeline_sums {
	uint64_t events; // events of the simulators and the host
	uint64_t lost; // events that found their ring full; the file lacks them
} ob_timeline_sums;

// Starts the timeline of a universe that is traced. NULL and e on failure.
ob_timeline *ob_timeline_start(ob_universe *u, const char *path, ob_error *e);
// Writes the remaining spans and these deaths, ends the file, and frees t (NULL is allowed). Workers that have not left
// should stand still: their later events are not in the file. false and e if the file is not whole.
bool ob_timeline_finish(ob_timeline *t, const ob_death *deaths, uint32_t n, ob_timeline_sums *sums, ob_error *e);

#endif
