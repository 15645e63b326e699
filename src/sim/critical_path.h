// The critical path of more workers than there are: what the steps would take with OB_SIMULATED_WORKERS of them, each on
// a core of its own, waking for nothing. It is told of timed runs, whatever number of workers they have.
//
//   phase       tasks as they were measured (CPU of each)         serial part
//   ISLANDS     [...............][....][...][..][.][.][.] ..       [index, pairs, islands]
//                      |           |     |    claimed in turns: each by whoever is free first
//   worker 0    |---------------|                                  |
//   worker 1    |----||---||--| ..                                 | adds up as it is
//   ..                                                             |
//
// A task is what a worker claims: in ISLANDS a chunk, which would be cut for so many workers, so islands are measured, and
// put into chunks here as island_builder.c puts them. To it comes what a worker does in a phase beside its tasks, of the
// one with the most of it.
//
// What it does not know: memory and caches that so many workers share, and that a wake-up takes time. It says what the
// division of the work allows, no more.
//
// Contained simulators do not tell of their tasks, and where each object has a worker of its own there are none: of such
// runs it is not told.
#ifndef OB_SIM_CRITICAL_PATH_H
#define OB_SIM_CRITICAL_PATH_H

#include "table/table.h"

// By the scheduling worker, before anything else, at the end of a timed phase. per_worker: for so many tasks one worker
// more takes part in such a phase; 0: all do.
void ob_critical_path_close(ob_universe *u, ob_phase phase, uint32_t per_worker);
#endif
