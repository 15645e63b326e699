// A worker of a free run solved in groups (group_worker.c).
#ifndef OB_FREE_GROUP_WORKER_H
#define OB_FREE_GROUP_WORKER_H

#include "table/table.h"

// Runs the worker until the run stops. false and e: no memory.
bool ob_free_work_in_groups(ob_universe *u, uint32_t number, ob_error *e);

#endif
