// Snapshots of a run, in memory: its whole state at step boundaries, to which it can be put back, again and again. A
// snapshot is a checkpoint as restarts use it (restart.h), kept until it is forgotten.
//
// Thread-safety: the thread that goes and waits, between a wait and the next go.
#ifndef OB_HOST_SNAPSHOTS_H
#define OB_HOST_SNAPSHOTS_H

#include "host/population.h"
#include "table/checkpoint.h"

typedef struct ob_host ob_host;

typedef struct ob_kept_snapshot {
	ob_checkpoint *universe; // NULL: forgotten
	ob_kept_population *population;
} ob_kept_snapshot;

typedef struct ob_snapshots {
	ob_kept_snapshot *at; // [count]
	size_t count;
} ob_snapshots;

// Takes a snapshot and returns its number, from 1; 0 and e: no memory, or a monolith, whose state ODE does not expose.
uint64_t ob_host_keep_snapshot(ob_host *h, ob_error *e);
// Puts the run back. All workers are started again. false and e: there is no such snapshot, or the run has failed.
bool ob_host_restore_snapshot(ob_host *h, uint64_t number, ob_error *e);
bool ob_host_forget_snapshot(ob_host *h, uint64_t number, ob_error *e);
void ob_snapshots_finish(ob_snapshots *s);

#endif
