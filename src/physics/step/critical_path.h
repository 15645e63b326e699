// Critical path of more workers than there are: duration of steps with OB_SIMULATED_WORKERS workers, each on a core of
// its own, with wake-ups that cost nothing. Timed runs report it, with any number of workers.
//
//   phase       tasks as they were measured (CPU of each)         serial part
//   ISLANDS     [...............][....][...][..][.][.][.] ..       [index, pairs, islands]
//                      |           |     |    claimed in turns: each by the first free worker
//   worker 0    |---------------|                                  |
//   worker 1    |----||---||--| ..                                 | adds up as it is
//   ..                                                             |
//
// A task is the unit that a worker claims. In ISLANDS it is a chunk, whose size depends on the number of workers:
// islands are measured, and grouped into chunks here as island_builder.c does. Work beside tasks is added: as much as
// the busiest worker did of it in the phase.
//
// Not modelled: memory and caches shared by so many workers, and the time of a wake-up. The result is the bound set by
// the division of the work.
//
// Contained simulators do not report their tasks, and runs with a worker per object have none: neither has a critical
// path.
#ifndef OB_STEP_CRITICAL_PATH_H
#define OB_STEP_CRITICAL_PATH_H

#include "table/table.h"

// Closes a timed phase and adds its critical path. The scheduling worker calls it at the phase's end, before anything
// else. per_worker: number of tasks per additional worker in such a phase; 0: all workers take part.
void ob_critical_path_close(ob_universe *u, ob_phase phase, uint32_t per_worker);
#endif
