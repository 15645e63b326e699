// The life of a worker, the same in a thread and in a process.
#ifndef OB_HOST_WORKER_H
#define OB_HOST_WORKER_H

#include "table/table.h"

// An ob_worker_run (keeper.h).
int ob_worker_live(ob_universe *u, uint32_t worker);

#endif
