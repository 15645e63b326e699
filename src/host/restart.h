// Simulators that are lost, and begin again. A process dies alone; what it computed with lies in the universe, perhaps
// half changed. So all go back to where the universe last stood as a whole, and come to the same bits as if nobody had
// died.
//
//   host, in wait              supervisor                  keeper                    simulators
//   pause: checkpoint          .                           .                         ... | ... | ...
//   sleeps until a pause       .                           .                          |    X     |
//   .                          lost, gate stopped  <-----  SIGCHLD  <----------------------+     |
//   wakes  <-----------------  .                           .                          leave, those that can
//   kill  ---------------------------------------------->  SIGKILL  ---------------->  X         X
//   all have ended  <--------  counts ends  <------------  .
//   puts the checkpoint back   .                           .
//   restart  ------------------------------------------->  fork  ------------------> ... | ... | ...
//   they are ready: next leg
//
// A checkpoint is taken at a pause, when objects have come or gone, or else four times a second; but not so often that
// it takes more than a twentieth of the time. A simulator that hangs is lost as well.
//
// A run fails as before where there is nothing to go back to: with threads (they die with the host); with a monolith,
// whose world lies in its simulator's own memory; when one after the other is lost for ten seconds and the run does not
// get on, for then it is likely to be the simulator's own doing; and when one is lost after so many objects have come or gone that there
// was no time to keep it.
//
// Thread-safety: lose may be called by any thread, the rest by the one that goes and waits.
#ifndef OB_HOST_RESTART_H
#define OB_HOST_RESTART_H

#include "host/host.h"

// Makes ready. Without it, or with no memory for it, a loss is a failure.
void ob_restart_prepare(ob_host *h);
// At a pause: changed = objects came or went.
void ob_restart_checkpoint(ob_host *h, bool changed);
// Whether it is time for a pause to keep the universe.
bool ob_restart_checkpoint_due(const ob_host *h);
// A simulator is gone, or of no more use. The first loss counts until ob_restart.
void ob_restart_lose(ob_host *h, const char *format, ...) __attribute__((format(printf, 2, 3)));
// After a loss: all simulators begin again, and stand at the gate, the universe at a pause. false: the run has failed, or
// another was lost in the meantime.
bool ob_restart(ob_host *h);
void ob_restart_finish(ob_host *h);

#endif
