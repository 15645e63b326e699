// Contacts that begin in a step, noted for the scripts of their bodies: on_contact is called before the next step
// (step/scripts.h). The solver of a body's island notes them (results.h), or the one ODE world.
#ifndef OB_EXCHANGE_TOUCHES_H
#define OB_EXCHANGE_TOUCHES_H

#include "table/table.h"

// True if the script of a member receives its contacts.
bool ob_touches_are_felt(const ob_universe *u, const ob_island *is);
// Forgets the touches noted in an earlier attempt to solve the island.
void ob_touches_begin(ob_universe *u, const ob_island *is);
// Notes that two objects began to touch at a point (m), or adds to their normal impulse (N s).
void ob_touches_note(ob_universe *u, uint32_t a, uint32_t b, double impulse, ob_vec3 point);

#endif
