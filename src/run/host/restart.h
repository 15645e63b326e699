// Restart from a checkpoint. A process dies alone, but its data in the universe may be half changed. So all workers are
// killed, the universe is put back to the last checkpoint, and new workers go on from there. They come to the same bits
// as if no worker had died.
//
//   host, in wait              supervisor                  fork server               workers
//   pause: checkpoint          .                           .                         ... | ... | ...
//   sleeps until a pause       .                           .                          |    X     |
//   .                          request, gate stop  <-----  SIGCHLD  <----------------------+     |
//   wakes  <-----------------  .                           .                          leave, those that can
//   kill  ---------------------------------------------->  SIGKILL  ---------------->  X         X
//   all have ended  <--------  counts ends  <------------  .
//   puts the checkpoint back   .                           .
//   restart  ------------------------------------------->  fork  ------------------> ... | ... | ...
//   they are ready: runs on
//
// A checkpoint is taken at a pause, four times a second, unless checkpoints would take more than a twentieth of the
// time. Others are taken after a thousand requests, and, after a restart, half way to the step of the death. Later
// changes by timetable, scripts and requests are done again, in the same pauses (journal.h). A stall (host.h) requests
// a restart, too.
//
// Freezing (ob_on_death): the dead simulator's objects, or those of the island that failed, are noted with their place
// (journal.h): the number of complete steps, and whether the scripts before the coming step had run. Then the restart
// goes as above; the run pauses in that place again, the objects become static, their scripts stop, and a checkpoint is
// taken. So they stay where they were when their simulator died, wherever the checkpoint was. All islands that are too much in
// a step are frozen at once, and new requests wait until it is complete: each attempt would find more of them. If it dies in
// the same step of every run, all runs end in the same bits. Threads restart, too, once they have left, which they do unless
// they hang.
//
// The run fails where a restart is impossible, useless, or not wanted:
//   - by policy, or if simulators have died more often than the limit allows;
//   - with threads, which die with the host, unless failing objects are frozen;
//   - with a monolith, whose world lies in its worker's own memory;
//   - when workers fail again and again for ten seconds and the run does not get past its checkpoint: then the simulator
//     itself is likely to be the cause. Deaths by SIGKILL, which others send, end it only after the run's patience;
//   - when there is no memory for a checkpoint, or for the requests since.
//
// Thread-safety: ob_restart_request may be called by any thread, the rest by the thread that goes and waits.
#ifndef OB_HOST_RESTART_H
#define OB_HOST_RESTART_H

#include "host/host.h"
#include "host/population.h"
#include "table/checkpoint.h"

// Prepares restarts. Without it, or with no memory for it, a request is a failure.
void ob_restart_prepare(ob_host *h);
// At a pause, takes a checkpoint if one is due, or if objects were frozen.
void ob_restart_checkpoint(ob_host *h, bool frozen);
// Step at which the run pauses for a checkpoint in any case; UINT64_MAX: none.
uint64_t ob_restart_next_step(const ob_host *h);
// True if objects are to be frozen, or requests to be carried out again, once the scripts before the coming step have run.
bool ob_restart_is_due_after_scripts(const ob_host *h);
// True if a pause for a checkpoint is due.
bool ob_restart_checkpoint_due(const ob_host *h);
// Requests a restart: a worker has died, or is stalled. The first request counts until ob_restart. In a free run, which has
// no checkpoint, it ends the run.
void ob_restart_request(ob_host *h, const ob_death *d);
// In a free run: starts one worker again, whose simulators go on where they had published. The supervisor calls it.
void ob_restart_worker(ob_host *h, const ob_death *d);
// In a free run: kills the workers that block it (h->blocks), to start each again with this death, a stall. false: that is
// impossible, or useless.
bool ob_restart_stalled(ob_host *h, const ob_death *d);
// Adds the last words of a worker that has ended, if it is the one of the request.
void ob_restart_add_words(ob_host *h, const ob_worker_end *end);
// Before the first step: plans to freeze the objects that a log lists as frozen. false: no memory.
bool ob_restart_replay(ob_host *h, const ob_logged_requests *l);
// At a pause: freezes the objects noted for this place. true: there were some.
bool ob_restart_freeze(ob_host *h);
// After a request: restarts all workers; they then stand at the gate, the universe at a pause. false: the run has failed,
// or another worker died in the meantime, which is a request again.
bool ob_restart(ob_host *h);
// At a pause, without damage: goes on from a snapshot (host/restart.h). false: the run has failed, or is interrupted.
bool ob_restart_restore(ob_host *h, const ob_checkpoint *c, const ob_kept_population *k);
void ob_restart_finish(ob_host *h);

// ---- snapshots

// Snapshots of a run, in memory: its whole state at step boundaries, to which it can be put back, again and again. A
// snapshot is a checkpoint as restarts use it (restart.h), kept until it is forgotten.
//
// Thread-safety: the thread that goes and waits, between a wait and the next go.

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
