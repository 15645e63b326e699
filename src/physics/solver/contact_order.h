// Order in which an island's contacts are loaded, and so coloured and solved. It depends on the pairs' geometry, never
// on ids or on the place in the world. An iterative solution depends on the order: so it is the same for a scene that
// is turned, moved, or lists its objects in another order.
#ifndef OB_SOLVER_CONTACT_ORDER_H
#define OB_SOLVER_CONTACT_ORDER_H

#include "solver/solver.h"

// Writes order[in->pairs]: indices into the island's pairs, for bodies as loaded. Equal pairs keep the order of the
// list. contact_key must have space for 2 * in->pairs keys.
void ob_contact_order(ob_solver *s, const ob_island_input *in, uint32_t *order);

#endif
