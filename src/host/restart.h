// Restart from a checkpoint. A process dies alone, but leaves what it computed with in the universe, perhaps half
// changed. So all workers are killed, the universe is put back to the last checkpoint, and new workers go on from there;
// they come to the same bits as if no worker had died.
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
// A checkpoint is taken at a pause: when objects have been added or removed, or else four times a second, but not so
// often that checkpoints take more than a twentieth of the time; after a restart, half way to where simulators died. A stall (host.h) asks for a restart, too.
//
// The run fails where a restart is impossible or of no use:
//   - with threads, which die with the host;
//   - with a monolith, whose world lies in its worker's own memory;
//   - when workers have died again and again for ten seconds and the run has not got past its checkpoint, for then the
//     simulator itself is likely to be the cause;
//   - when so many objects have been added and removed that there was no time for a checkpoint since.
//
// Thread-safety: ob_restart_request may be called by any thread, the rest by the one that goes and waits.
#ifndef OB_HOST_RESTART_H
#define OB_HOST_RESTART_H

#include "host/host.h"

// Makes ready. Without it, or with no memory for it, a request is a failure.
void ob_restart_prepare(ob_host *h);
// At a pause, takes a checkpoint if one is due; changed = objects were added or removed.
void ob_restart_checkpoint(ob_host *h, bool changed);
// The step at which the run pauses for one in any case; UINT64_MAX: none.
uint64_t ob_restart_next_step(const ob_host *h);
// Whether it is time for a pause to take a checkpoint.
bool ob_restart_checkpoint_due(const ob_host *h);
// A worker has died, or is stalled, for this reason. The first request counts until ob_restart.
void ob_restart_request(ob_host *h, const char *format, ...) __attribute__((format(printf, 2, 3)));
// After a request: restarts all workers; they then stand at the gate, the universe at a pause. false: the run has failed,
// or another worker died in the meantime, which is a request again.
bool ob_restart(ob_host *h);
void ob_restart_finish(ob_host *h);

#endif
