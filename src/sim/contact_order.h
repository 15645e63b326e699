// The order in which an island's contacts are loaded, and so coloured and solved: by what a pair is, never by its ids
// or by where in the world it is. An iterative solution depends on the order; so a scene whose objects come in another
// order, or that is turned or moved, has the same one.
#ifndef OB_SIM_CONTACT_ORDER_H
#define OB_SIM_CONTACT_ORDER_H

#include "sim/state.h"

// order[is->pairs]: indices into the island's pairs, for bodies as they are loaded. Pairs that are alike keep the order
// of the list. There must be room for 2 * is->pairs keys in contact_key.
void ob_contact_order(ob_sim *s, const ob_island *is, uint32_t *order);

#endif
