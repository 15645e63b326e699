// Workers as threads or as processes. Everything above this line of the code speaks to an ob_spawn and does not know
// which of the two it is; spawn_thread.c and spawn_process.c are the only files that do.
//
// Thread-safety: one thread at a time per crew.
#ifndef OB_HOST_SPAWN_H
#define OB_HOST_SPAWN_H

#include "host/fork_server.h"

typedef struct ob_crew ob_crew; // the workers of one universe

typedef struct ob_crew_order {
	ob_universe *u;
	ob_fork_server *keeper;
	ob_worker_run run;
} ob_crew_order;

typedef struct ob_spawn {
	const char *name; // of the isolation, for readers of the universe
	// Starts all workers of order->u. It returns before they are ready: they announce themselves in the
	// universe. NULL and e on failure, with nothing left running.
	ob_crew *(*start)(const ob_crew_order *order, ob_error *e);
	// Readable when next_end has something.
	int (*fd)(const ob_crew *c);
	// Fetches one worker that has ended, without waiting; false: none at the moment.
	bool (*next_end)(ob_crew *c, ob_worker_end *end);
	// Both NULL where a worker cannot be lost alone. kill: puts an end to all. restart: starts all anew, when the ends
	// of all have been fetched; false: that is not possible any more.
	void (*kill)(ob_crew *c);
	bool (*restart)(ob_crew *c);
	// ns of CPU time that the worker has used; 0 when it is gone.
	uint64_t (*cpu)(const ob_worker_info *w);
	// After ob_gate_stop: waits until all have left, at most timeout (s), and frees c. false: some have not
	// left and may still touch the universe.
	bool (*join)(ob_crew *c, double timeout);
	double leave_patience; // s to join for: a process that lingers can be killed, a thread cannot
	bool own_memory; // a worker has a memory of its own, apart from the host's
} ob_spawn;

extern const ob_spawn ob_spawn_threads, ob_spawn_processes;

#endif
