// The timeline: a thread that takes the spans out of the universe's rings (table/trace.h) some twenty times a second
// and writes them to a file, while the run goes on.
//
// Thread-safety: start and finish are one thread's.
#ifndef OB_HOST_TIMELINE_H
#define OB_HOST_TIMELINE_H

#include "host/death.h"
#include "table/trace.h"

typedef struct ob_timeline ob_timeline;

typedef struct ob_timeline_sums {
	uint64_t events; // of the simulators and the host
	uint64_t lost; // of these, those that found their ring full; they are missing in the file
} ob_timeline_sums;

// On a universe that is traced. NULL and e on failure.
ob_timeline *ob_timeline_start(ob_universe *u, const char *path, ob_error *e);
// Writes what is there, and of these deaths what was learnt of each, ends the file, frees t (NULL is allowed). Workers that have not left should stand still: what
// they do from now on is not in the file. false and e if it is not whole.
bool ob_timeline_finish(ob_timeline *t, const ob_death *deaths, uint32_t n, ob_timeline_sums *sums, ob_error *e);

#endif
