// Workers as threads or as processes. Everything above this interface speaks to an ob_spawn and does not know which of
// the two it is; spawn_thread.c and spawn_process.c are the only files that do.
//
// Thread-safety: one thread at a time per group.
#ifndef OB_HOST_SPAWN_H
#define OB_HOST_SPAWN_H

#include "host/fork_server.h"

typedef struct ob_worker_group ob_worker_group; // the workers of one universe

typedef struct ob_worker_group_setup {
	ob_universe *u;
	ob_fork_server *fork_server;
	ob_worker_run run;
} ob_worker_group_setup;

typedef struct ob_spawn {
	const char *name; // of the isolation, for readers of the universe
	// Starts all workers of setup->u. It returns before they are ready: they announce themselves in the
	// universe. NULL and e on failure, with nothing left running.
	ob_worker_group *(*start)(const ob_worker_group_setup *setup, ob_error *e);
	// Readable when next_end has something.
	int (*fd)(const ob_worker_group *g);
	// Fetches the report of one worker that has ended, without waiting; false: none at the moment.
	bool (*next_end)(ob_worker_group *g, ob_worker_end *end);
	// end: ends all workers; processes at once, threads when they come to the gate or look up from a long step.
	// restart: starts all anew, once the ends of all have been fetched. false and e: they do not start.
	void (*end)(ob_worker_group *g);
	bool (*restart)(ob_worker_group *g, ob_error *e);
	// ns of CPU time that the worker has used; 0 when it is gone.
	uint64_t (*cpu)(const ob_worker_info *w);
	// After ob_gate_stop: waits until all have left, at most timeout (s), and frees g. false: some have not
	// left and may still touch the universe.
	bool (*join)(ob_worker_group *g, double timeout);
	double leave_timeout; // s to join for: a process that does not leave can be killed, a thread cannot
	bool own_memory; // a worker has an address space of its own, apart from the host's, and can die alone
} ob_spawn;

// What a join may sleep at once (ms) when it has "left" seconds: its hang clock ticks in between (base/clock.h).
static inline int ob_spawn_poll_ms(double left)
{
	return left < .1 ? (int)(1000 * left) + 1 : 100;
}

extern const ob_spawn ob_spawn_threads, ob_spawn_processes;

#endif
