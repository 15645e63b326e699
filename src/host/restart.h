// Restart from a checkpoint. A process dies alone, but leaves what it computed with in the universe, perhaps half
// changed. So all workers are killed, the universe is put back to the last checkpoint, and new workers go on from
// there; they come to the same bits as if no worker had died.
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
// A checkpoint is taken at a pause, four times a second, but not so often that checkpoints take more than a twentieth
// of the time; where a thousand requests have been carried out since the last; and after a restart half way to where
// simulators died. What the timetable, scripts and requests have changed since then is done again, in the same pauses
// (journal.h). A stall (host.h) asks for a restart, too.
//
// Freezing (ob_on_death): the objects of whom has died, or of the island that has failed, are noted with the number of
// steps that were complete. Then all is as above; the run pauses where that many are complete again, the objects become
// static, and a checkpoint is taken. So they stand where they stood when their simulator died, wherever the checkpoint
// was, and where it dies in the same step of every run, all runs end in the same bits. Threads restart, too: when they
// have left, which they do unless they hang.
//
// The run fails where a restart is impossible or of no use, or not wanted:
//   - where it is to abort, or simulators have died more often than its limit allows;
//   - with threads, which die with the host, unless what fails is to be frozen;
//   - with a monolith, whose world lies in its worker's own memory;
//   - when workers have died again and again for ten seconds and the run has not got past its checkpoint, for then the
//     simulator itself is likely to be the cause;
//   - when there is no memory for a checkpoint, or for the requests since.
//
// Thread-safety: ob_restart_request may be called by any thread, the rest by the one that goes and waits.
#ifndef OB_HOST_RESTART_H
#define OB_HOST_RESTART_H

#include "host/host.h"

// Makes ready. Without it, or with no memory for it, a request is a failure.
void ob_restart_prepare(ob_host *h);
// At a pause, takes a checkpoint if one is due, or objects were frozen.
void ob_restart_checkpoint(ob_host *h, bool frozen);
// The step at which the run pauses for one in any case; UINT64_MAX: none.
uint64_t ob_restart_next_step(const ob_host *h);
// Whether it is time for a pause to take a checkpoint.
bool ob_restart_checkpoint_due(const ob_host *h);
// A worker has died, or is stalled, so. The first request counts until ob_restart.
void ob_restart_request(ob_host *h, const ob_death *d);
// The words of a worker that has been ended, if it is the one that the request is about.
void ob_restart_add_words(ob_host *h, const ob_worker_end *end);
// Before the first step: what a log says was frozen is to be frozen again. false: no memory.
bool ob_restart_replay(ob_host *h, const ob_logged_requests *l);
// At a pause: freezes what is to be frozen at this step. true: some was.
bool ob_restart_freeze(ob_host *h);
// After a request: restarts all workers; they then stand at the gate, the universe at a pause. false: the run has failed,
// or another worker died in the meantime, which is a request again.
bool ob_restart(ob_host *h);
void ob_restart_finish(ob_host *h);

#endif
