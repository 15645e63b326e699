// Where an object's simulator lives: the worker that was given its island last, the leading body's if each object has a
// worker of its own. Nothing that a simulator needs lies in a worker, so one that moves takes nothing with it, and no
// bit of the run depends on it.
//
//   whoever asks            the scheduler                            workers
//   ob_move_ask  ---------> ob_move_take, between two steps
//                           ob_move_make: the object has a pin
//                           deals islands (sim/island_builder.h) --> solve what they were given: ob_home_set
//
// Of several ranks the first is asked, and tells the others with its next message (sim/peers.h).
#ifndef OB_TABLE_HOME_H
#define OB_TABLE_HOME_H

#include "table/table.h"

// Asks that an object's simulator move to a worker; any thread of the host. false: the last that was asked for has not
// been made yet.
bool ob_move_ask(ob_universe *u, uint32_t object, uint32_t worker);
// What was asked for; 0: nothing. The scheduler.
uint64_t ob_move_take(ob_universe *u);
// Makes it, 0: none; from here on the object has a pin. The scheduler, of each rank alike.
void ob_move_make(ob_universe *u, uint64_t move);
// Whether any object has one.
bool ob_moves_were_made(const ob_universe *u);
// Another object takes this one's number. While the universe stands still.
void ob_pin_drop(ob_universe *u, uint32_t object);

// The home; at first, as what is created together lies together, by the object's number.
uint32_t ob_home_of(const ob_universe *u, uint32_t object);
// The rank of which that is.
uint32_t ob_home_rank(const ob_universe *u, uint32_t object);
// By who is given it, or gives it.
void ob_home_set(ob_universe *u, uint32_t object, uint32_t worker);

#endif
