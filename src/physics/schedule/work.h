// Work of a step: its limit, and fair shares of it. Work is counted, never timed; unit: step/budget.h.
#ifndef OB_SCHEDULE_WORK_H
#define OB_SCHEDULE_WORK_H

#include "table/table.h"

// Work of some us: for less the gate costs more than another worker gains.
enum { OB_WORK_WORTH_A_WORKER = 48 };

// Returns the work that a step may take. Any thread.
uint64_t ob_work_limit(const ob_universe *u);
// Adds work done on this object to the step's. Returns true if that exceeds the limit; then the step has failed. Any
// worker.
bool ob_work_add(ob_universe *u, uint64_t work, uint32_t object);
// Returns the work of a full share when "count" simulators, or ranks, divide the total: others get the excess. Pure.
uint64_t ob_work_share(uint64_t total, uint32_t count);

#endif
