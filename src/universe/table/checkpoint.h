// A checkpoint: the universe as it stood at a step boundary, copied into the host's own memory, and put back when a
// simulator has died.
//
//                          take                       put back
//   motions            newest of each slot   -->   published anew: readers see one more version, never a torn one
//   step data          pages in use          -->   the same bytes; pages that came into use since are zeroed
//   clock, tasks       values                -->   the same values
//   passports          newest of each slot   -->   written anew; what was not there then goes before motions do
//   gate, workers      -                     -->   they stay, as do counters and traces
//
// Workers that have died, and the gate that they left at some point, are forgotten apart, before others begin.
//
// These hold everything that an object needs from one step to the next, so the steps that follow are the same to the bit.
//
// Thread-safety: one thread, the host's, while the universe is paused (take), or has no worker (put back). Deaths may be
// noted at any time.
#ifndef OB_TABLE_CHECKPOINT_H
#define OB_TABLE_CHECKPOINT_H

#include "table/table.h"

typedef struct ob_checkpoint ob_checkpoint;

ob_checkpoint *ob_checkpoint_create(void); // NULL: out of memory
// Returns false if memory runs out; nothing can then be put back.
bool ob_checkpoint_take(ob_checkpoint *c, const ob_universe *u);
void ob_checkpoint_put_back(const ob_checkpoint *c, ob_universe *u);
// All workers have left: clears their pids; the gate is as at the start: the host has the turn, no worker has arrived.
void ob_checkpoint_forget_workers(ob_universe *u);
// Number of complete steps at the checkpoint.
uint64_t ob_checkpoint_step(const ob_checkpoint *c);
void ob_checkpoint_destroy(ob_checkpoint *c); // NULL is allowed

#endif
