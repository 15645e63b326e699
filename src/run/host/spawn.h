// Workers as threads, as processes, or as the calling thread. Code above this interface uses an ob_spawn without regard to the kind; only
// spawn_thread.c, spawn_process.c and spawn_inside.c depend on it.
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
	const char *name; // name of the isolation, for readers of the universe
	// Starts all workers of setup->u. It returns before they are ready: they announce themselves in the
	// universe. NULL and e on failure, with nothing left running.
	ob_worker_group *(*start)(const ob_worker_group_setup *setup, ob_error *e);
	// Readable when next_end has something.
	int (*fd)(const ob_worker_group *g);
	// Fetches the report of one worker that has ended, without waiting; false: none at the moment.
	bool (*next_end)(ob_worker_group *g, ob_worker_end *end);
	// end: ends all workers; processes at once, threads at the gate or at the next check within a long step.
	// restart: starts all anew, once the ends of all have been fetched. false and e: they do not start.
	void (*end)(ob_worker_group *g);
	bool (*restart)(ob_worker_group *g, ob_error *e);
	// Starts one worker again, whose end was fetched, while the others go on; NULL: it cannot die alone.
	bool (*revive)(ob_worker_group *g, uint32_t worker);
	// Kills one worker, whose end is reported; NULL: it cannot die alone. Any thread.
	bool (*kill)(ob_worker_group *g, uint32_t worker);
	// CPU time of the worker in ns; 0 when it is gone.
	uint64_t (*cpu)(const ob_worker_info *w);
	// After ob_gate_stop: waits until all have left, at most timeout (s), and frees g. false: some have not left
	// and may still access the universe.
	bool (*join)(ob_worker_group *g, double timeout);
	// Works for the thread that waits for the run, until the host has its turn; NULL: workers run by themselves, and each
	// end is reported. false: no memory.
	bool (*pass)(ob_worker_group *g);
	double leave_timeout; // s, for join: a process that does not leave can be killed, a thread cannot
	bool own_memory; // a worker has an address space apart from the host's, and can die alone
} ob_spawn;

// Longest single sleep of a join (ms) with "left" seconds to go: its hang clock ticks in between (base/clock.h).
static inline int ob_spawn_poll_ms(double left)
{
	return left < .1 ? (int)(1000 * left) + 1 : 100;
}

extern const ob_spawn ob_spawn_threads, ob_spawn_processes, ob_spawn_inside;

#endif
