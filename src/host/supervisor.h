// The supervisor: a thread of the host that hears of workers' deaths, of signals, and of the keeper's end, and keeps
// the workers' CPU times in the universe up to date. It sleeps in poll otherwise.
#ifndef OB_HOST_SUPERVISOR_H
#define OB_HOST_SUPERVISOR_H

#include "host/host.h"

bool ob_supervisor_start(ob_host *h, ob_error *e);
void ob_supervisor_stop(ob_host *h); // allowed if it was never started

#endif
