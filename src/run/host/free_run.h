// The host's lead of a free run, in place of the gate: limits how far simulators may run, and keeps the common time.
//
//   step    common          target        until
//           |---------------|-------------|            the host completes the steps that all have passed
//            simulators are somewhere here             until: at most a window ahead of the common time, and no further
//                                                      than the next object that comes or goes
//
// Objects change while the common time is at `until`: then all wait there. Thread-safety: the thread that goes and waits.
#ifndef OB_HOST_FREE_RUN_H
#define OB_HOST_FREE_RUN_H

#include "host/host_state.h"

// True if simulators may be ahead of the common time: objects cannot be changed now.
bool ob_host_free_is_ahead(const ob_host *h);
// Has simulators follow the clock at this pace (s a second), from the common time on; 0: they stand once they have passed
// `stands`, a step. The same pace again changes nothing.
void ob_host_free_pace(ob_host *h, double pace, uint64_t stands);
// Enters objects that were changed, and lets simulators run on.
void ob_host_free_resume(ob_host *h);
// Completes the steps that all have passed, up to the interval's end. true: the end is reached, or a simulator has failed;
// false: not within timeout (s).
bool ob_host_free_wait(ob_host *h, double timeout);

#endif
