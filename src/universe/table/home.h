// Home of an object's simulator: the worker that was given its island last, the leading body's if each object has a
// worker of its own. A worker has no state of a simulator, so a simulator moves without data, and no bit of the run
// depends on its home.
//
//   any thread              the scheduler                            workers
//   ob_move_ask  ---------> ob_move_take, between two steps
//                           ob_move_make: the object has a pin
//                           deals islands (step/island_builder.h) --> solve their islands: ob_home_set
//
// On several ranks, rank 0 takes the requests and sends them to the others with its next message (cluster/peers.h).
#ifndef OB_TABLE_HOME_H
#define OB_TABLE_HOME_H

#include "table/table.h"

// Requests that an object's simulator move to a worker; any thread of the host. Returns false while the previous
// request is pending.
bool ob_move_ask(ob_universe *u, uint32_t object, uint32_t worker);
// Takes the requested move; 0: none. Called by the scheduler.
uint64_t ob_move_take(ob_universe *u);
// Makes a move, 0: none; from here on the object has a pin. Called by the scheduler, alike on each rank.
void ob_move_make(ob_universe *u, uint64_t move);
// True if any object has a pin.
bool ob_moves_were_made(const ob_universe *u);
// Removes a pin, as another object takes this number. Call while the universe stands still.
void ob_pin_drop(ob_universe *u, uint32_t object);

// Home worker; initially by the object's number, as objects created together are mostly close together.
uint32_t ob_home_of(const ob_universe *u, uint32_t object);
// Rank of the home worker.
uint32_t ob_home_rank(const ob_universe *u, uint32_t object);
// Sets the home; called by the worker that receives the object, or assigns it.
void ob_home_set(ob_universe *u, uint32_t object, uint32_t worker);

#endif
