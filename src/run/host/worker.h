// A worker, the same in a thread, in a process and within a program: the code it runs, and the report of its end.
#ifndef OB_HOST_WORKER_H
#define OB_HOST_WORKER_H

#include "table/table.h"

enum { OB_WORKER_NO_MEMORY = 3 }; // exit code of a worker that could not get enough memory

// Code of a worker, in its own thread or process, from start to end. 0 = it left after STOP, as it should.
typedef int (*ob_worker_run)(ob_universe *u, uint32_t worker);

// The ob_worker_run of all runs: object simulators (or the monolith) until STOP.
int ob_worker_live(ob_universe *u, uint32_t worker);

// The same, step by step, for a thread that has other things to do, too (spawn_inside.c). All in one thread.
typedef struct ob_worker ob_worker;
// Begins a worker, which may be pinned to a core, and announces it. NULL and e: no memory.
ob_worker *ob_worker_begin(ob_universe *u, uint32_t number, bool pinned, ob_error *e);
// Takes part in phases until the host has its turn, or the gate is stopped. false: no memory; nothing of it may be used again.
bool ob_worker_pass(ob_worker *w);
void ob_worker_leave(ob_worker *w); // NULL is allowed

// Last lines that a process wrote on standard error, as many as fit, newest last, with | between them.
enum { OB_LAST_WORDS = 400 };

typedef struct ob_worker_end {
	uint32_t worker;
	int32_t pid; // of its process
	int32_t error; // errno when its start failed; else 0
	int32_t signal; // signal that killed it; else 0
	int32_t code; // its exit code; 0 = it left after STOP
	char words[OB_LAST_WORDS]; // "" = none; a thread has none of its own
} ob_worker_end;

#endif
