// A worker, the same in a thread and in a process: what it runs, and how its end is reported.
#ifndef OB_HOST_WORKER_H
#define OB_HOST_WORKER_H

#include "table/table.h"

enum { OB_WORKER_NO_MEMORY = 3 }; // the exit code of a worker that could not get the memory that it needs

// What a worker runs, in its own thread or process, from its start to its end. 0 = it left after STOP, as it should.
typedef int (*ob_worker_run)(ob_universe *u, uint32_t worker);

// The ob_worker_run of all runs: object simulators (or the monolith) until STOP.
int ob_worker_live(ob_universe *u, uint32_t worker);

// The last lines that a process has written on standard error, as many as there is room for, newest last, with | between
// them.
enum { OB_LAST_WORDS = 400 };

typedef struct ob_worker_end {
	uint32_t worker;
	int32_t pid; // of its process
	int32_t error; // errno when it could not be started at all; else 0
	int32_t signal; // that killed it; else 0
	int32_t code; // its exit code; 0 = it left after STOP
	char words[OB_LAST_WORDS]; // "" = none; a thread has none of its own
} ob_worker_end;

#endif
